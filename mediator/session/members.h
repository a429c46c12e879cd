#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/base/ids.h"

// The members and views of a scene.
namespace tessera::session {

struct Member {
    SessionId session;
    std::string name, user;  // user: of the key
    std::string text;        // presence
    std::vector<ObjectId> selection;
    bool editor = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock minus the master's, +- bound
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &Member::session), row(2, "name", &Member::name),
                          row(3, "user", &Member::user), row(4, "text", &Member::text),
                          row(5, "selection", &Member::selection), row(6, "editor", &Member::editor),
                          row(7, "clock_offset_seconds", &Member::clock_offset_seconds),
                          row(8, "clock_bound_seconds", &Member::clock_bound_seconds));
    }
};
struct ObjectLock {
    ObjectId object;
    std::string name;  // of the member that holds it
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "object", &ObjectLock::object), row(2, "name", &ObjectLock::name));
    }
};
struct ViewEntry {
    std::string name, owner;
    std::uint32_t width = 0, height = 0;
    std::uint64_t samples = 0, spp = 0;  // per pixel: mean so far, and final
    std::uint64_t watchers = 0;
    double noise = 0.0;  // as in ViewProgress
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &ViewEntry::name), row(2, "owner", &ViewEntry::owner),
                          row(3, "width", &ViewEntry::width), row(4, "height", &ViewEntry::height),
                          row(5, "samples", &ViewEntry::samples), row(6, "spp", &ViewEntry::spp),
                          row(7, "watchers", &ViewEntry::watchers), row(8, "noise", &ViewEntry::noise));
    }
};
struct Members {
    std::string title;  // of the scene
    std::vector<Member> members;
    std::vector<ObjectLock> locks;
    std::vector<ViewEntry> views;
    std::uint64_t unlisted = 0;  // locks, members and views that did not fit
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "title", &Members::title), row(2, "members", &Members::members),
                          row(3, "locks", &Members::locks), row(4, "views", &Members::views),
                          row(5, "unlisted", &Members::unlisted));
    }
};

}  // namespace tessera::session

#pragma once

#include <cstdint>
#include <string>
#include <tuple>
#include <vector>

#include "mediator/base/description.h"
#include "mediator/base/ids.h"

// Who is in a scene, and which views it has.
namespace tessera::session {

struct Person {
    SessionId session;
    std::string name, user;  // user: of the key
    std::string text;        // presence
    std::vector<ObjectId> selection;
    bool editor = false;
    double clock_offset_seconds = 0, clock_bound_seconds = 0;  // its clock less the master's, +- bound
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "session", &Person::session), row(2, "name", &Person::name),
                          row(3, "user", &Person::user), row(4, "text", &Person::text),
                          row(5, "selection", &Person::selection), row(6, "editor", &Person::editor),
                          row(7, "clock_offset_seconds", &Person::clock_offset_seconds),
                          row(8, "clock_bound_seconds", &Person::clock_bound_seconds));
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
    std::uint64_t samples = 0, spp = 0;  // per pixel, the least so far and in the end
    std::uint64_t watchers = 0;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "name", &ViewEntry::name), row(2, "owner", &ViewEntry::owner),
                          row(3, "width", &ViewEntry::width), row(4, "height", &ViewEntry::height),
                          row(5, "samples", &ViewEntry::samples), row(6, "spp", &ViewEntry::spp),
                          row(7, "watchers", &ViewEntry::watchers));
    }
};
struct People {
    std::string title;  // of the scene
    std::vector<Person> people;
    std::vector<ObjectLock> locks;
    std::vector<ViewEntry> views;
    static constexpr auto describe(auto row) {
        return std::tuple(row(1, "title", &People::title), row(2, "people", &People::people),
                          row(3, "locks", &People::locks), row(4, "views", &People::views));
    }
};

}  // namespace tessera::session

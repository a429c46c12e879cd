// What members of a scene see of each other.
#include <algorithm>

#include "master/scene_session.h"
#include "mediator/wire/envelope.h"

namespace tessera::master {

namespace {

constexpr std::size_t MaxPresenceText = 1024, MaxSelection = 1024;
constexpr Duration MaxPresence = std::chrono::minutes(10);

// The encoded reply with as much as fits: thousands of locks, or sixty members with long selections, do not.
net::Bytes fitting(wire::Members reply) {
    session::Members& all = reply.content;
    const auto halve = [&](auto& list) {
        const std::size_t kept = list.size() / 2;
        all.unlisted += list.size() - kept;
        list.resize(kept);
    };
    net::Bytes message = wire::encode(wire::ControlMessage(reply));
    while (!wire::fits_control(message)) {
        if (all.locks.size() > 64) {
            halve(all.locks);
        } else {
            halve(all.members);
            halve(all.views);
            halve(all.locks);
        }
        message = wire::encode(wire::ControlMessage(reply));
    }
    return message;
}

}  // namespace

// Why a viewer may not open this view: viewers share the cluster with those who edit. "" = it may.
std::string SceneSession::viewer_problem(const SessionRecord& session, std::uint64_t number,
                                         const session::ViewRequest& wanted) const {
    constexpr std::size_t MaxViews = 8;                          // of all viewers of a key
    constexpr std::uint64_t MaxPixels = std::uint64_t{1} << 25;  // in all; 8K
    constexpr std::uint64_t MaxSpp = 65536;
    if (session.role != net::Role::Viewer) return {};
    if (wanted.stop.spp > MaxSpp) return "a viewer may ask for 65536 samples per pixel at most";
    std::size_t views = 1;
    std::uint64_t pixels = wanted.view.window.pixel_count();
    const auto replaced = views_.watched(session.id, number);
    for (const auto& [id, view] : views_.table().all()) {
        if (view.owner.user != session.user || id == replaced) continue;
        ++views;
        pixels += view.request.view.window.pixel_count();
    }
    if (views > MaxViews)
        return "viewers of this key have 8 views already: close some, or watch one by its name";
    if (pixels > MaxPixels) return "the views of this viewer's key would have more than 33 million pixels";
    return {};
}

std::string MemoryUse::problem(std::uint64_t bytes, const std::string& what) const {
    if (used <= limit && bytes <= limit - used) return {};
    return "the master has no room for " + what + ", " + std::to_string(bytes >> 20) +
           " MiB: " + std::to_string(used >> 20) + " of " + std::to_string(limit >> 20) +
           " MiB are used; close views, remove objects, or start it with a larger --memory";
}

ViewMemory SceneSession::view_memory(std::optional<ViewId> left_out) const {
    ViewMemory views;
    for (const auto& [id, view] : views_.table().all()) {
        if (id != left_out) views.add(view.request);
    }
    return views;
}

MemoryUse SceneSession::memory_with(const ViewMemory& views) const {
    return {services_.blobs->byte_size() + services_.outbox.waiting_bytes() + views.bytes(), memory_limit_};
}

std::string SceneSession::memory_problem(std::uint64_t bytes, const std::string& what) const {
    return memory().problem(bytes, what);
}

std::string SceneSession::memory_problem(const session::ViewRequest& completed,
                                         std::optional<ViewId> replaced) const {
    ViewMemory views = view_memory(replaced);
    const MemoryUse before = memory_with(views);
    const std::uint64_t bytes_before = views.bytes();
    views.add(completed);
    return before.problem(views.bytes() - bytes_before, "the film and the denoiser of this view");
}

void SceneSession::handle(SessionRecord& session, wire::SetPresence request, TimePoint now) {
    Member& member = members_.at(session.id);
    request.text.resize(std::min(request.text.size(), MaxPresenceText));
    request.selection.resize(std::min(request.selection.size(), MaxSelection));
    member.presence_until = now + std::clamp(request.time_to_live, Duration::zero(), MaxPresence);
    member.presence = std::move(request);
}

void SceneSession::handle(SessionRecord& session, const wire::ReadMembers& request, TimePoint now) {
    session::Members members{.title = title(), .locks = authority_.locks()};
    for (const auto& [id, member] : members_) {
        const SessionRecord* other = services_.sessions.find(id);
        if (other == nullptr) continue;
        session::Member entry{.session = id,
                              .name = member.name,
                              .user = other->user,
                              .editor = other->role != net::Role::Viewer};
        if (const auto clock = other->clock.offset(now)) {
            entry.clock_offset_seconds = seconds(clock->offset);
            entry.clock_bound_seconds = seconds(clock->bound);
        }
        if (now < member.presence_until) {
            entry.text = member.presence.text;
            entry.selection = member.presence.selection;
        }
        members.members.push_back(std::move(entry));
    }
    for (const auto& [id, live] : views_.table().all()) {
        members.views.push_back(
            {.name = live.name,
             .owner = live.owner.name,
             .width = live.request.view.width,
             .height = live.request.view.height,
             .samples = live.shown ? live.shown->samples / live.request.view.window.pixel_count() : 0,
             .spp = live.request.stop.spp,
             .watchers = views_.watchers(id),
             .noise = live.run.noise});
    }
    services_.outbox.control(session.control, fitting({request.request, std::move(members)}));
}

}  // namespace tessera::master

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
             .watchers = views_.watchers(id)});
    }
    services_.outbox.control(session.control, fitting({request.request, std::move(members)}));
}

}  // namespace tessera::master

#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/wire/messages.h"
#include "node/scene_replica.h"
#include "node/settings.h"

namespace tessera::node {

// What the loop has to do for the machine. Order matters.
struct SendControl {
    wire::ControlMessage message;
};
struct SendBulk {
    wire::BulkMessage message;
};
struct SendFilm {  // then tell film_sent()
    UnitId unit;
    std::vector<wire::FilmPart> parts;
};
struct HoldBulk {};  // the master does not know who is at its end
struct OpenBulk {    // ends the hold; before anything else
    std::uint64_t token = 0;
};
struct DropFilm {};   // what waits to be sent belongs to nobody any more
struct Reconnect {};  // new sockets; what was said on the old ones is void
struct Render {       // then tell finished()
    view::View view;
    view::WorkUnit unit;
};
struct StopUnit {
    UnitId unit;
};
struct BuildScene {  // then tell built()
    SceneReplica::Build build;
};
struct LoadBlobs {  // from the cache, if they are there; then tell looked_up()
    std::vector<scene::BlobRef> blobs;
};
struct SaveBlob {
    scene::BlobPtr blob;
};
struct Report {
    wire::Severity severity = wire::Severity::Info;
    std::string text;
};
using Action = std::variant<SendControl, SendBulk, SendFilm, HoldBulk, OpenBulk, DropFilm, Reconnect, Render,
                            StopUnit, BuildScene, LoadBlobs, SaveBlob, Report>;

// What the parts of the machine want done, in the order in which they want it, and what they count.
struct Effects {
    std::vector<Action> actions;
    NodeCounters counters;
    bool state_changed = false;  // the master is to hear of it at once, by a heartbeat

    void add(Action action) { actions.push_back(std::move(action)); }
    void send(wire::ControlMessage message) { add(SendControl{std::move(message)}); }
    void report(wire::Severity severity, std::string text) { add(Report{severity, std::move(text)}); }
    void malformed(const std::string& reason) {
        ++counters.malformed_messages;
        report(wire::Severity::Warning, "dropped a message of the master: " + reason);
    }
};

}  // namespace tessera::node

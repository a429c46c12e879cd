#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/base/log_subject.h"
#include "mediator/wire/messages.h"
#include "node/scene_replica.h"
#include "node/settings.h"

namespace tessera::node {

// Actions that the event loop executes for the state machine, in order.
struct SendControl {
    wire::ControlMessage message;
};
struct SendBulk {
    wire::BulkMessage message;
};
struct SendFilm {  // then call film_sent() for each unit
    std::vector<UnitId> units;
    std::vector<wire::FilmPart> parts;
};
struct WithdrawFilm {  // unless it is being sent: then call film_withdrawn() for each unit that it was of
    UnitId unit;
};
struct FilmTaken {  // bytes in all that the master has taken over this link
    std::uint64_t bytes = 0;
};
struct PauseBulk {};  // the master has not authenticated the bulk link yet
struct OpenBulk {     // resumes it; the token is sent first
    std::uint64_t token = 0;
};
struct DiscardPendingFilm {};  // queued film is no longer wanted
struct Reconnect {};           // new sockets; messages queued on the old ones are lost
struct Render {                // then call finished()
    view::View view;
    view::WorkUnit unit;
};
struct StopUnit {
    UnitId unit;
};
struct BuildScene {  // then call built()
    SceneReplica::Build build;
};
struct LoadBlobs {  // from the disk cache, if present; then call looked_up()
    std::vector<scene::BlobRef> blobs;
};
struct SaveBlob {
    scene::BlobPtr blob;
};
struct Report {
    wire::Severity severity = wire::Severity::Info;
    std::string text;
    LogSubject about{};
    bool is_detail = false;  // a step in the life of a unit: for --log-level debug
};
using Action =
    std::variant<SendControl, SendBulk, SendFilm, PauseBulk, OpenBulk, DiscardPendingFilm, Reconnect,
                 WithdrawFilm, FilmTaken, Render, StopUnit, BuildScene, LoadBlobs, SaveBlob, Report>;

// Actions requested by the parts of the state machine, in order, and their counters.
struct Effects {
    std::vector<Action> actions;
    NodeCounters counters;
    bool state_changed = false;  // send a heartbeat immediately

    void add(Action action) { actions.push_back(std::move(action)); }
    void send(wire::ControlMessage message) { add(SendControl{std::move(message)}); }
    void report(wire::Severity severity, std::string text) { add(Report{severity, std::move(text)}); }
    void trace(const view::WorkUnit& unit, std::string text) {
        add(Report{.text = std::move(text),
                   .about = {.view = unit.view, .unit = unit.id, .version = unit.version},
                   .is_detail = true});
    }
    void malformed(const std::string& reason) {
        ++counters.malformed_messages;
        report(wire::Severity::Warning, "dropped a message of the master: " + reason);
    }
};

}  // namespace tessera::node

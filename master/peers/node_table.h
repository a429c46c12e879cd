#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "master/peers/node_capacity.h"
#include "master/peers/quarantine.h"
#include "mediator/net/channel.h"
#include "mediator/net/clock_offset.h"
#include "mediator/net/liveness.h"
#include "mediator/view/view.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// What the master knows of one node.
struct NodeRecord {
    NodeId id;
    std::uint64_t token = 0;
    net::PeerId control = 0;
    std::optional<net::PeerId> bulk;  // known after its BulkHello
    std::string user;                 // of its key; a token works only for the same user
    wire::Hello hello;
    bool is_null = false;  // its back-end renders test patterns instead of the scene
    net::Liveness liveness;
    wire::Heartbeat state;  // the latest, and when it came: what our next heartbeat echoes
    TimePoint heartbeat_at{};
    Version sent;                       // of the last change list sent to it
    Version reported;                   // committed, hash agrees
    TimePoint sent_at{};                // when
    std::uint64_t awaits = 0;           // the job that encodes the next change list for it; 0 = none
    Version refused;                    // did not fit into its memory
    std::string refusal;                // why
    std::uint32_t hash_mismatches = 0;  // at the version `sent`
    std::uint64_t work_sequence = 0;
    std::map<UnitId, std::uint64_t> pending;  // work sent and not yet confirmed by a heartbeat, by sequence
    std::map<UnitId, TimePoint>
        unreported_since;  // neither in flight on the node nor merged: film on the wire, or lost
    std::map<ViewId, std::uint64_t> views;  // opened, and at which revision
    bool leaving = false;
    bool quarantined = false;        // gets no work; see quarantine.h
    std::uint64_t film_taken = 0;    // bytes of film messages merged or dropped since its welcome
    bool film_taken_is_new = false;  // not reported to it yet
    double round_trip_seconds = 0;
    net::PeerClock clock;
    std::uint64_t last_progress = 0;  // for stuck detection
    TimePoint last_progress_at{};
    Duration allowance{};  // of the units that it has; see Dispatcher::allowance()
    bool stuck = false;
    bool stuck_is_announced = false;
    std::set<std::string> announced;  // why it takes no part, each reason once

    Quarantine::Key identity() const { return {user, hello.name}; }

    // The message to send before work on the view; nothing if the node has this revision already.
    std::optional<wire::OpenView> opening(const view::View& view, Duration hold_film);

    // Free slots as reported by the node, less the units sent since.
    NodeCapacity capacity() const;
};

// How long a node whose heartbeats arrive may make no progress.
struct StuckSettings {
    Duration allowance = std::chrono::seconds(30);  // while rendering; more for long units:
    double predicted_times = 10.0;                  // as often as a unit should take
    Duration first_film = std::chrono::minutes(5);  // until its first film of a pass: it may compile kernels
    Duration building = std::chrono::minutes(30);   // while it builds the scene
};

// Nodes by id, control peer and bulk peer. Pure: driven by events with their times.
class NodeTable {
  public:
    NodeTable(const net::LivenessSettings& liveness, const StuckSettings& stuck)
        : liveness_(liveness), stuck_(stuck) {}

    NodeRecord& add(NodeId id, std::uint64_t token, net::PeerId control, std::string user, wire::Hello hello,
                    TimePoint now);
    void remove(NodeId id);
    const StuckSettings& stuck() const { return stuck_; }
    // There is no node that renders the scene itself.
    bool all_are_null() const { return renderers_ == 0; }
    NodeRecord* by_control(net::PeerId peer);
    NodeRecord* by_bulk(net::PeerId peer);
    NodeRecord* by_token(std::uint64_t token);
    // The node to which the token belonged until it was removed, if that is not long ago.
    std::optional<NodeId> removed(std::uint64_t token) const;
    NodeRecord* find(NodeId id);
    std::map<NodeId, NodeRecord>& all() { return nodes_; }
    const std::map<NodeId, NodeRecord>& all() const { return nodes_; }

    void heartbeat(NodeRecord& node, const wire::Heartbeat& heartbeat, TimePoint now);
    std::vector<NodeId> timed_out(TimePoint now) const;
    // `held`: the units that the scheduler expects from this node. Returns those that the node has not reported
    // as in flight for longer than `timeout` and whose film has not arrived: they are lost.
    static std::vector<UnitId> overdue(NodeRecord& node, const std::vector<UnitId>& held, TimePoint now,
                                       Duration timeout);

  private:
    net::LivenessSettings liveness_;
    StuckSettings stuck_;
    std::map<NodeId, NodeRecord> nodes_;
    std::size_t renderers_ = 0;                // nodes that are not null
    std::map<NodeId, std::uint64_t> removed_;  // and their tokens; bounded
};

}  // namespace tessera::master

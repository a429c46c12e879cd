#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "master/peers/node_capacity.h"
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
    net::Liveness liveness;
    wire::Heartbeat state;  // the latest, and when it came: what our next heartbeat echoes
    TimePoint heartbeat_at{};
    Version sent;                       // of the last change list sent to it
    Version reported;                   // committed, hash agrees
    TimePoint sent_at{};                // when
    Version refused;                    // there was no room for it
    std::string refusal;                // why
    std::uint32_t hash_mismatches = 0;  // at the version `sent`
    std::uint64_t work_sequence = 0;
    std::map<UnitId, std::uint64_t> pending;  // work sent, by sequence, that no heartbeat has confirmed
    std::map<UnitId, TimePoint> silent;       // neither in hand nor merged, since: film under way, or lost
    std::map<ViewId, std::uint64_t> views;    // opened, and at which revision
    bool leaving = false;
    double round_trip_seconds = 0;
    net::PeerClock clock;
    std::uint64_t last_progress = 0;  // for stuck detection
    TimePoint last_progress_at{};
    bool stuck = false;

    // What it has to be told before work on the view; nothing when it knows this revision already.
    std::optional<wire::OpenView> opening(const view::View& view);

    // Free places by the node's own word, less what is on its way to it.
    NodeCapacity capacity() const;
};

struct StuckSettings {
    Duration allowance = std::chrono::seconds(30);  // without progress while rendering or building
};

// Nodes by id, control peer and bulk peer. Pure: told what happened and when.
class NodeTable {
  public:
    NodeTable(const net::LivenessSettings& liveness, const StuckSettings& stuck)
        : liveness_(liveness), stuck_(stuck) {}

    NodeRecord& add(NodeId id, std::uint64_t token, net::PeerId control, std::string user, wire::Hello hello,
                    TimePoint now);
    void remove(NodeId id) { nodes_.erase(id); }
    NodeRecord* by_control(net::PeerId peer);
    NodeRecord* by_bulk(net::PeerId peer);
    NodeRecord* by_token(std::uint64_t token);
    NodeRecord* find(NodeId id);
    std::map<NodeId, NodeRecord>& all() { return nodes_; }
    const std::map<NodeId, NodeRecord>& all() const { return nodes_; }

    void heartbeat(NodeRecord& node, const wire::Heartbeat& heartbeat, TimePoint now);
    std::vector<NodeId> dead(TimePoint now) const;
    // `held`: the units the scheduler counts on from this node. Those that the node has not had in hand for
    // longer than `patience`, without film of them: lost on the way.
    static std::vector<UnitId> overdue(NodeRecord& node, const std::vector<UnitId>& held, TimePoint now,
                                       Duration patience);

  private:
    net::LivenessSettings liveness_;
    StuckSettings stuck_;
    std::map<NodeId, NodeRecord> nodes_;
};

}  // namespace tessera::master

#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mediator/base/clock.h"
#include "mediator/base/ids.h"
#include "mediator/net/clock_offset.h"
#include "mediator/session/edits.h"
#include "mediator/session/status.h"

namespace tessera::master {

// Latency breakdown of the last 4096 edits, from the client to the first picture that shows them. All times are in
// the master's clock; times of peers are converted with the known clock offsets and are 0 (unknown) without one.
// Pure; single-threaded.
class EditTraceLog {
  public:
    static constexpr std::size_t MaxEdits = 4096;

    struct Submitted {
        std::uint64_t transaction = 0;
        std::string name;                       // who
        std::uint64_t bytes = 0;                // of its message
        std::int64_t submitted_at = 0;          // ns, the client's clock; 0 = unknown
        std::optional<net::ClockOffset> clock;  // the client's
        TimePoint received{};
        Version version;  // the version that will contain it; versions only grow within an epoch
    };
    void submitted(const Submitted& edit);
    // The version was sent to the nodes with all edits up to it.
    void published(Version version, TimePoint now);
    // From a VersionReport, with the node's clock offset. The first report of a node only sets its starting version:
    // earlier edits are not counted as delays.
    void node_built(NodeId node, const std::string& name, Version version, std::int64_t received_at,
                    std::int64_t built_at, const std::optional<net::ClockOffset>& clock);
    void node_gone(NodeId node) { nodes_.erase(node); }
    // A picture of this version was merged: the first one for all edits up to it that have none.
    void merged(Version version, TimePoint now);
    // No view is open: pending edits no longer wait for a picture.
    void no_open_views() { next_merged_ = end(); }

    // The latest `count` edits in their order.
    std::vector<session::EditTrace> latest(std::size_t count) const;
    // p50 and p99 (nearest rank) over the stored edits: "client to master", "master to published", "published to
    // node" and "node to built" (one value per edit and node), "built to picture" (from the first node),
    // "whole" (client to picture).
    std::vector<session::StageTimes> stages() const;
    std::uint64_t edit_count() const { return count_; }
    std::uint64_t edit_bytes() const { return bytes_; }  // of all, since the start

  private:
    // Edits are numbered in order; those before begin() are no longer stored.
    std::uint64_t begin() const { return count_ - edits_.size(); }
    std::uint64_t end() const { return count_; }
    void for_each_up_to(Version version, std::uint64_t& next,
                        const std::function<void(session::EditTrace&)>& visit);

    std::deque<session::EditTrace> edits_;
    std::uint64_t count_ = 0, bytes_ = 0;
    std::uint64_t next_published_ = 0, next_merged_ = 0;  // the first edit without it
    std::map<NodeId, std::uint64_t> nodes_;               // the first edit that each node has not built
};

}  // namespace tessera::master

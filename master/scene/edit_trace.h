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

// Where the time of an edit goes, from its client to the first picture that shows it: the last 4096 edits.
// All times are kept in the master's clock; those of peers are corrected by what is known of their clocks,
// and stay 0 (not known) where nothing is. Pure; one thread. A call costs what it changes.
class EditTraceLog {
  public:
    static constexpr std::size_t Kept = 4096;

    struct Submitted {
        std::uint64_t transaction = 0;
        std::string name;                       // who
        std::uint64_t bytes = 0;                // of its message
        std::int64_t submitted_at = 0;          // ns, the client's clock; 0 = not told
        std::optional<net::ClockOffset> clock;  // the client's
        TimePoint received{};
        Version version;  // that will hold it; versions never go back within an epoch
    };
    void submitted(const Submitted& edit);
    // The version went to the nodes: with all edits up to it.
    void published(Version version, TimePoint now);
    // As a VersionReport says, with what is known of the node's clock. The first report of a node only tells
    // where it starts: what it held before it came was no edit's delay.
    void node_built(NodeId node, const std::string& name, Version version, std::int64_t received_at,
                    std::int64_t built_at, const std::optional<net::ClockOffset>& clock);
    void node_gone(NodeId node) { nodes_.erase(node); }
    // A picture of this version is there: the first one for all edits up to it that have none.
    void merged(Version version, TimePoint now);
    // No view is open: what has no picture yet waits for none.
    void nobody_looks() { next_merged_ = end(); }

    // The latest `count` edits in their order.
    std::vector<session::EditTrace> latest(std::size_t count) const;
    // p50 and p99 (nearest rank) over what is kept: "client to master", "master to published", "published to
    // node" and "node to built" (one value per edit and node), "built to picture" (from the first node),
    // "whole" (client to picture).
    std::vector<session::StageTimes> stages() const;
    std::uint64_t edit_count() const { return count_; }
    std::uint64_t edit_bytes() const { return bytes_; }  // of all, since the start

  private:
    // Edits are numbered in their order; those below begin() are no longer kept.
    std::uint64_t begin() const { return count_ - edits_.size(); }
    std::uint64_t end() const { return count_; }
    void for_each_up_to(Version version, std::uint64_t& next,
                        const std::function<void(session::EditTrace&)>& visit);

    std::deque<session::EditTrace> edits_;
    std::uint64_t count_ = 0, bytes_ = 0;
    std::uint64_t next_published_ = 0, next_merged_ = 0;  // the first edit that is not
    std::map<NodeId, std::uint64_t> nodes_;               // the first edit that each one has not built
};

}  // namespace tessera::master

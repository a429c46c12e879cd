#pragma once

#include <algorithm>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "mediator/base/ids.h"

namespace tessera::master {

// What happened to a block of samples on the nodes that had it, as long as none has rendered it. It separates nodes that
// fail everywhere from samples that fail on every node.
struct UnitTrouble {
    enum class Kind : std::uint8_t {
        Failed,    // the back-end gave an error
        Vanished,  // the node disappeared while it may have been rendering it; most likely for another reason
        Killed     // the same, and nothing else that the node rendered had cost as many nodes before
    };
    std::vector<NodeId> failed_on;  // each node once
    std::uint32_t failures = 0;
    std::vector<NodeId> lost_with;  // nodes that disappeared; those that join later have other ids
    bool has_killed = false;
    std::string message;  // of the latest failure; of the latest loss if there is none

    void add(Kind kind, NodeId node, const std::string& text) {
        if (kind == Kind::Failed) {
            ++failures;
            if (!has_failed_on(node)) failed_on.push_back(node);
        } else {
            lost_with.push_back(node);
            has_killed = has_killed || kind == Kind::Killed;
        }
        if (kind == Kind::Failed || failures == 0) message = text;
    }
    bool has_failed_on(NodeId node) const {
        return std::find(failed_on.begin(), failed_on.end(), node) != failed_on.end();
    }
    // `survivors` only lost their connection.
    std::size_t lives(const std::set<NodeId>& survivors) const {
        return static_cast<std::size_t>(
            std::ranges::count_if(lost_with, [&](NodeId node) { return !survivors.contains(node); }));
    }
    // The samples are to blame, not the nodes: they failed on two (on one twice if there is no other), or have killed
    // `max_crashes`. Nodes that vanish for any reason (a lost connection, a preempted machine) are evidence only when there
    // is one more. `other_losses` are nodes that were lost without these samples. Where nodes die anyway, two of them may
    // have had the same samples by chance: then one or two more are needed.
    bool is_settled(std::size_t max_crashes, const std::set<NodeId>& survivors,
                    std::size_t other_losses = 0) const {
        const std::size_t needed =
            max_crashes + (has_killed ? 0 : 1) + std::min<std::size_t>(other_losses, 2);
        return failures >= 2 || lives(survivors) >= needed;
    }
};

}  // namespace tessera::master

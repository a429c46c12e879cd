#pragma once

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "mediator/base/ids.h"

namespace tessera::master {

// What happened to a block of samples on the nodes that had it, as long as none has rendered it. It separates nodes that
// fail everywhere from samples that fail on every node.
struct UnitTrouble {
    enum class Kind : std::uint8_t {
        Failed,   // the back-end gave an error
        Crashed,  // the node reported that its back-end crashed on it
        Vanished  // the node disappeared while it may have been rendering it; most likely for another reason
    };
    std::vector<NodeId> failed_on;  // failures and crashes, each node once
    std::uint32_t failures = 0, crashes = 0, vanished = 0;
    std::string message;  // of the latest failure

    void add(Kind kind, NodeId node, const std::string& text) {
        ++(kind == Kind::Failed ? failures : kind == Kind::Crashed ? crashes : vanished);
        if (kind == Kind::Vanished) {
            if (message.empty()) message = text;
            return;
        }
        if (!has_failed_on(node)) failed_on.push_back(node);
        message = text;
    }
    bool has_failed_on(NodeId node) const {
        return std::find(failed_on.begin(), failed_on.end(), node) != failed_on.end();
    }
    // The samples are to blame, not the nodes: they failed on two (on one twice if there is no other). Nodes that vanish
    // without a word (a lost connection, a preempted machine) are evidence only when there are three in a row.
    bool is_settled() const { return failures + crashes >= 2 || vanished >= 3; }
};

}  // namespace tessera::master

#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/fuzz/random_peer.h"

namespace tessera::test {

struct FuzzSettings {
    std::uint64_t seed = 1;
    std::uint64_t messages = 25'000;  // of the random peers, in all
    std::size_t peers = 8;
};

struct FuzzReport {
    std::uint64_t messages = 0, edits = 0, frames = 0;  // of the peers; of the honest
    std::uint64_t faults = 0;                           // of links and the disk
    std::uint64_t peak_memory = 0;                      // bytes, of this process
    Reached reached;
    double longest_step_cpu = 0.0;  // s
    std::string longest_part;
    std::vector<std::string> violations;  // of the invariants; empty = none
};

// A master with honest nodes, an honest editor who keeps a record of the own objects, and an honest client who renders a
// frame whose bits are known; and peers of every role who send whatever is legal. Seeded: the same seed sends the same
// messages, though threads may serve them in another order.
FuzzReport fuzz_cluster(const FuzzSettings& settings);

}  // namespace tessera::test

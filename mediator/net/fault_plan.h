#pragma once

#include <memory>

#include "mediator/net/channel.h"

namespace tessera::net {

// Faults injected on one link, random but repeatable: for a given seed the k-th message of a peer in one direction
// always gets the same faults. Probabilities per message.
struct FaultPlan {
    std::uint64_t seed = 0;
    double lose = 0, duplicate = 0, reorder = 0;
    Duration min_delay{0}, max_delay{0};
    std::uint64_t cut_after_messages = 0;  // counted over both directions, which are cut then; 0 = never
};

// Wraps a channel and injects faults when sending and receiving. Only bulk has to tolerate reordering; on control
// `reorder` and `lose` deliberately break the transport's guarantees (resync has to repair it). Delayed messages are
// sent by the next call of send() or receive(); send() of a lost message returns Sent.
std::unique_ptr<Channel> with_faults(std::unique_ptr<Channel> inner, const FaultPlan& control,
                                     const FaultPlan& bulk);

}  // namespace tessera::net

#pragma once

#include <memory>

#include "mediator/net/channel.h"

namespace tessera::net {

// What goes wrong on one link, by chance but repeatable: for one seed the k-th message of a peer in one
// direction always meets the same fate. Probabilities per message.
struct FaultPlan {
    std::uint64_t seed = 0;
    double lose = 0, duplicate = 0, reorder = 0;
    Duration min_delay{0}, max_delay{0};
    std::uint64_t cut_after_messages = 0;  // of both directions together, which are dead then; 0 = never
};

// Decorates any channel, for sending and receiving alike. Whoever must bear reordering is bulk; on control,
// `reorder` and `lose` break the transport's promise on purpose (resync has to heal it). What was delayed is
// sent by the next call of send() or receive(); a lost message is Sent.
std::unique_ptr<Channel> with_faults(std::unique_ptr<Channel> inner, const FaultPlan& control,
                                     const FaultPlan& bulk);

}  // namespace tessera::net

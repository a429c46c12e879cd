#pragma once

#include <memory>

#include "mediator/net/channel.h"

namespace tessera::net {

// What goes wrong, by chance but repeatable: one seed, one history of decisions per channel. Probabilities
// per message.
struct FaultPlan {
    std::uint64_t seed = 0;
    double lose = 0, duplicate = 0, reorder = 0;
    Duration min_delay{0}, max_delay{0};
    std::uint64_t cut_after_messages = 0;  // 0 = never; then both directions are dead
};

// Decorates any channel, for sending and receiving alike. Whoever must bear reordering is bulk; on control,
// `reorder` and `lose` break the transport's promise on purpose (resync has to heal it).
std::unique_ptr<Channel> with_faults(std::unique_ptr<Channel> inner, const FaultPlan& control,
                                     const FaultPlan& bulk);

}  // namespace tessera::net

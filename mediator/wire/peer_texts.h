#pragma once

#include <cstddef>

#include "mediator/wire/messages.h"

namespace tessera::wire {

inline constexpr std::size_t MaxTextBytes = 1024;

// Cuts messages, reasons and notices of nodes to MaxTextBytes. They end up in the log, in the status of all and in summaries,
// which have to fit messages of their own. Nodes cut what they send, the master what it receives.
void shorten_texts(ControlMessage& message);

}  // namespace tessera::wire

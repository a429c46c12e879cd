#pragma once

#include <cstdint>

#include "mediator/base/clock.h"
#include "mediator/base/ids.h"

namespace tessera::master {

// How many units a node can take now.
struct NodeCapacity {
    NodeId node;
    std::uint32_t workers = 1;
    std::uint32_t free_slots = 0;
    std::uint32_t in_flight = 0;
    double round_trip_seconds = 0.0;  // of messages; 0 = not known
    TimePoint heartbeat_at{};         // its latest one
};

}  // namespace tessera::master

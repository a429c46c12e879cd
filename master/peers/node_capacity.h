#pragma once

#include <cstdint>

#include "mediator/base/ids.h"

namespace tessera::master {

// What a node can take now.
struct NodeCapacity {
    NodeId node;
    std::uint32_t workers = 1;
    std::uint32_t free_places = 0;
    std::uint32_t in_hand = 0;
};

}  // namespace tessera::master

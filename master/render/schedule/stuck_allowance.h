#pragma once

#include <cstdint>

#include "master/peers/node_table.h"

namespace tessera::master {

// What units of at most so many pixel samples may take a node until it finishes one of them. `rate`: pixel samples per
// second; 0 = not measured.
Duration stuck_allowance(const StuckSettings& settings, double rate, std::uint64_t samples);

}  // namespace tessera::master

#pragma once

#include "backends/embree/kernel.h"

// Kernels that have the features of one scene in tests/scenes and no other.
namespace tessera::embree {

extern const Kernel RoomKernel, StillKernel, StudioKernel;

}  // namespace tessera::embree

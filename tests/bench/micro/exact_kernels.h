#pragma once

#include "backends/embree/kernel.h"

// Kernels that have the features of one scene and no other.
namespace tessera::embree {

// Of tests/scenes.
extern const Kernel RoomKernel, StillKernel, StudioKernel;

// Of seldom_scenes.h, by their names.
namespace exact {
extern const Kernel none, coat, sheen, anisotropy, rough_glass, film, attenuation, fog, motion, shader,
    catcher, shaped_lights;
}

}  // namespace tessera::embree

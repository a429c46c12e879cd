#pragma once

#include "backends/embree/kernel.h"

// Kernels compiled for exactly the features of one scene.
namespace tessera::embree {

// For files of tests/scenes.
extern const Kernel RoomKernel, StillKernel, StudioKernel;

// For the scenes of rare_feature_scenes.h, by name.
namespace exact {
extern const Kernel none, coat, sheen, anisotropy, rough_glass, thin_glass, film, attenuation, fog, motion,
    shader, catcher, area_lights;
}

}  // namespace tessera::embree

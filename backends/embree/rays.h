#pragma once

#include <embree3/rtcore.h>

#include "mediator/shading/rays.h"
#include "mediator/shading/sampler.h"
#include "mediator/shading/thin_walls.h"

// The rays of the shared transport (mediator/shading/transport.h).
namespace tessera::embree {

// The scene that rays are traced through, and the view and time that they are traced for.
struct Rays {
    const shading::Scene& scene;
    const shading::View& view;
    RTCScene top;
    float time = 0.0f;
};

bool trace_closest(const Rays& rays, const shading::Ray& ray, const shading::Sampler& numbers,
                   const shading::Skip& skip, shading::Hit& hit);
bool trace_occluded(const Rays& rays, const glm::vec3& origin, const glm::vec3& segment, float far,
                    const shading::Sampler& numbers, shading::ThinWalls& walls);

}  // namespace tessera::embree

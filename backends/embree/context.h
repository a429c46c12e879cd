#pragma once

#include <embree3/rtcore.h>

#include "mediator/backend/story.h"

// What the shared transport asks of this back-end (mediator/shading/transport.h).
namespace tessera::embree {

struct Context : backend::Teller {
    const shading::Scene& scene;
    const shading::View& view;
    RTCScene top;
    float time = 0.0f;
};

bool trace_closest(const Context& context, const shading::Ray& ray, std::uint32_t seed,
                   const shading::Skip& skip, shading::Hit& hit);
bool trace_occluded(const Context& context, const glm::vec3& origin, const glm::vec3& segment, float far,
                    std::uint32_t seed);

}  // namespace tessera::embree

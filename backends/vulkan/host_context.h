#pragma once

#include "mediator/backend/path_log.h"
#include "mediator/shading/bvh_trace.h"
#include "mediator/shading/thin_walls.h"
#include "mediator/shading/transport.h"

namespace tessera::vulkan {

// What the shared transport asks for, as in shaders/trace.comp, on the host. `pool`: downloaded from the device.
struct HostContext : backend::PathLogger {
    const shading::Scene& scene;
    const shading::View& view;
    float time;
    shading::BvhItems pool;
    std::uint32_t top;
    shading::Skip skip = shading::skip_nothing();
    shading::ThinWalls* walls = nullptr;  // not null: a ray to a light
};

inline bool stops_ray(const HostContext& context, const shading::Hit& candidate,
                      const shading::Sampler& numbers) {
    if (context.walls != nullptr && shading::is_thin_wall(context.scene, candidate.instance)) {
        *context.walls = shading::unknown_thin_walls();
        return false;
    }
    if (shading::skips(context.skip, candidate.instance, candidate.distance)) return false;
    return shading::stops_at(context.scene, context.skip, candidate.instance, candidate.triangle,
                             candidate.barycentric, numbers);
}

inline bool trace_closest(const HostContext& context, const shading::Ray& ray,
                          const shading::Sampler& numbers, const shading::Skip& skip, shading::Hit& hit) {
    HostContext asked = context;
    asked.skip = skip;
    hit =
        shading::bvh_trace(context.pool, context.top, ray.origin, ray.direction, skip.near,
                           shading::infinity(), shading::BvhClosest | shading::BvhAlpha | shading::BvhMotion,
                           context.view.layers, context.time, asked, numbers);
    return hit.instance != shading::NoInstance;
}

inline bool trace_occluded(const HostContext& context, const glm::vec3& origin, const glm::vec3& segment,
                           float far, const shading::Sampler& numbers, shading::ThinWalls& walls) {
    walls = shading::no_thin_walls();
    HostContext asked = context;
    asked.walls = &walls;
    asked.skip.unlit = true;
    return shading::bvh_trace(context.pool, context.top, origin, segment, shading::NearestHit, far,
                              shading::BvhAny | shading::BvhAlpha | shading::BvhMotion, context.view.layers,
                              context.time, asked, numbers)
               .instance != shading::NoInstance;
}

}  // namespace tessera::vulkan

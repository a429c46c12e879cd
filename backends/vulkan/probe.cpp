#include "backends/vulkan/probe.h"

#include "backends/vulkan/device/transfer.h"
#include "mediator/backend/path_log.h"
#include "mediator/shading/bvh_trace.h"
#include "mediator/shading/raster.h"
#include "mediator/shading/trace.h"

namespace tessera::vulkan {

namespace {

// What the shared transport asks for, as in shaders/trace.comp.
struct HostContext : backend::PathLogger {
    const shading::Scene& scene;
    const shading::View& view;
    float time;
    shading::BvhItems pool;
    std::uint32_t top;
    shading::Skip skip = shading::skip_nothing();
    bool* meets_walls = nullptr;  // not null: a ray to a light
};

bool stops_ray(const HostContext& context, const shading::Hit& candidate, const shading::Sampler& numbers) {
    if (context.meets_walls != nullptr && shading::is_thin_wall(context.scene, candidate.instance)) {
        *context.meets_walls = true;
        return false;
    }
    if (shading::skips(context.skip, candidate.instance, candidate.distance)) return false;
    return shading::stops_at(context.scene, context.skip, candidate.instance, candidate.triangle,
                             candidate.barycentric, numbers);
}

bool trace_closest(const HostContext& context, const shading::Ray& ray, const shading::Sampler& numbers,
                   const shading::Skip& skip, shading::Hit& hit) {
    HostContext asked = context;
    asked.skip = skip;
    hit =
        shading::bvh_trace(context.pool, context.top, ray.origin, ray.direction, skip.near,
                           shading::infinity(), shading::BvhClosest | shading::BvhAlpha | shading::BvhMotion,
                           context.view.layers, context.time, asked, numbers);
    return hit.instance != shading::NoInstance;
}

bool trace_occluded(const HostContext& context, const glm::vec3& origin, const glm::vec3& segment, float far,
                    const shading::Sampler& numbers, bool& meets_walls) {
    meets_walls = false;
    HostContext asked = context;
    asked.meets_walls = &meets_walls;
    asked.skip.unlit = true;
    return shading::bvh_trace(context.pool, context.top, origin, segment, shading::NearestHit, far,
                              shading::BvhAny | shading::BvhAlpha | shading::BvhMotion, context.view.layers,
                              context.time, asked, numbers)
               .instance != shading::NoInstance;
}

// Assumes that the rasteriser finds the same hit as a ray, which holds except at edges.
shading::Path trace_drawn(const HostContext& context, glm::uvec2 pixel, std::uint64_t sample) {
    const shading::Path start =
        shading::start_path(shading::make_sampler(pixel.x, pixel.y, context.view.seed, sample));
    const shading::Ray ray =
        shading::camera_ray(context.view, pixel.x, pixel.y, shading::raster_place(context.view, sample));
    return shading::trace_from(context, start, ray, shading::FirstHit{});
}

}  // namespace

std::vector<std::string> replay(Device& device, const GpuScene& scene, const backend::SceneTables& tables,
                                const shading::View& view, glm::uvec2 pixel, std::uint64_t sample) {
    const auto pool = download<glm::uvec4>(device, scene.pool());
    shading::Scene on_host = backend::on_host(tables);
    on_host.features = backend::features_for(tables, view);
    backend::PathLog path_log;
    const float time = shading::sample_time(on_host.features, view, pixel.x, pixel.y, sample);
    const HostContext context{{&path_log}, on_host, view, time, {pool.data()}, scene.top()};
    const shading::Path path = view.renderer == shading::RendererRaster
                                   ? trace_drawn(context, pixel, sample)
                                   : shading::trace_sample(context, pixel.x, pixel.y, sample);
    backend::write_end(path_log, shading::radiance_of(path.found), path.rays);
    return path_log;
}

}  // namespace tessera::vulkan

#include "backends/vulkan/probe.h"

#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/host_context.h"
#include "mediator/shading/raster.h"
#include "mediator/shading/trace.h"

namespace tessera::vulkan {

namespace {

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
    const HostContext context{{.path_log = &path_log}, on_host, view, time, {pool.data()}, scene.top()};
    const shading::Path path = view.renderer == shading::RendererRaster
                                   ? trace_drawn(context, pixel, sample)
                                   : shading::trace_sample(context, pixel.x, pixel.y, sample);
    backend::write_end(path_log, shading::radiance_of(path.found), path.rays);
    return path_log;
}

}  // namespace tessera::vulkan

#include "backends/vulkan/sky_cells.h"

#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/host_context.h"
#include "mediator/shading/trace.h"

namespace tessera::vulkan {

DeviceSkyCells::DeviceSkyCells(Device& device, const backend::SkyCells& cells) {
    if (cells.empty()) return;
    nodes_ = make_buffer(device, cells.nodes);
    cells_ = make_buffer(device, cells.cells);
    cdfs_ = make_buffer(device, cells.cdfs);
}

void DeviceSkyCells::use_in(shading::View& view, std::uint32_t first_sample) const {
    if (cells_.size() == 0) return;
    view.sky_nodes.items = reinterpret_cast<const shading::SkyNode*>(nodes_.address());
    view.sky_cells.items = reinterpret_cast<const shading::SkyCell*>(cells_.address());
    view.sky_cdfs.items = reinterpret_cast<const float*>(cdfs_.address());
    view.sky_cells_from = first_sample;
}

std::optional<backend::SkyCells> make_sky_cells(Device& device, const GpuScene& scene,
                                                const backend::SceneTables& tables, const shading::View& view,
                                                std::uint32_t threads, const std::stop_token& stop) {
    const auto pool = download<glm::uvec4>(device, scene.pool());
    shading::Scene on_host = backend::on_host(tables);
    on_host.features = backend::features_for(tables, view);
    const auto context = [&](float time, std::vector<backend::SkyPlace>* places) {
        return HostContext{{.sky_places = places}, on_host, view, time, {pool.data()}, scene.top()};
    };
    const backend::SkyRays rays{
        .trace_path =
            [&](std::uint32_t x, std::uint32_t y, std::uint64_t sample,
                std::vector<backend::SkyPlace>& places) {
                const float time = shading::sample_time(on_host.features, view, x, y, sample);
                (void)shading::trace_sample(context(time, &places), x, y, sample);
            },
        .sees_sky =
            [&](const backend::SkyPlace& place, const glm::vec3& direction, std::uint32_t number) {
                shading::ThinWalls walls;
                return !trace_occluded(context(0.0f, nullptr), place.origin, direction, shading::infinity(),
                                       shading::Sampler(number, 0u), walls);
            }};
    return backend::make_sky_cells(tables, view, rays, threads, stop);
}

}  // namespace tessera::vulkan

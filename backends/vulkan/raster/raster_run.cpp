#include "backends/vulkan/raster/raster_run.h"

#include <algorithm>

#include "backends/vulkan/raster/raster_cell.h"

namespace tessera::vulkan {

RasterRun::RasterRun(Device& device, const RasterTools& tools, const GpuScene& scene,
                     const shading::View& view, std::uint64_t view_address, const Rect& tile)
    : device_(device),
      kernels_(tools.kernels.find(scene.features())),
      target_(tools.targets.take(std::min(view.width, cell_edge(view)),
                                 std::min(view.height, cell_edge(view)), scene.instance_count())),
      settings_(tools.settings),
      view_(view),
      pass_{device, kernels_, scene, *target_, settings_, view_, view_address},
      tile_(tile) {}

void RasterRun::draw(std::vector<Step>& steps, std::uint64_t first, std::uint32_t count) {
    current_ = 1 - current_;
    Buffer& seen = seen_[current_];
    const std::uint64_t bytes = tile_.pixel_count() * target_->ids.pixel_bytes();
    if (seen.size() < count * bytes) seen = Buffer(device_, count * bytes);
    for (std::uint32_t i = 0; i < count; ++i) pass_.add_steps(steps, tile_, first + i, seen, i * bytes);
}

}  // namespace tessera::vulkan

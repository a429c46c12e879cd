#pragma once

#include <memory>
#include <stop_token>

#include "backends/vulkan/gpu_scene.h"
#include "mediator/backend/sky_cells.h"

namespace tessera::vulkan {

// The sky cells of a view (mediator/shading/sky_cells.h) in the device's memory.
class DeviceSkyCells {
  public:
    DeviceSkyCells() = default;  // none
    DeviceSkyCells(Device& device, const backend::SkyCells& cells);

    // The buffers must outlive its use.
    void use_in(shading::View& view, std::uint32_t first_sample) const;

  private:
    Buffer nodes_, cells_, cdfs_;
};

// Traced on the host with the acceleration structure downloaded from the device. nullopt: stopped. Throws DeviceLost.
std::optional<backend::SkyCells> make_sky_cells(Device& device, const GpuScene& scene,
                                                const backend::SceneTables& tables, const shading::View& view,
                                                std::uint32_t threads, const std::stop_token& stop);

}  // namespace tessera::vulkan

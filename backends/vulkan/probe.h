#pragma once

#include <glm/vec2.hpp>
#include <string>
#include <vector>

#include "backends/vulkan/gpu_scene.h"

namespace tessera::vulkan {

// Replays one sample on the host with the same shading code, using the acceleration structure downloaded from
// the device. Returns a line per path vertex, then the radiance. Throws DeviceLost.
std::vector<std::string> replay(Device& device, const GpuScene& scene, const backend::SceneTables& tables,
                                const shading::View& view, glm::uvec2 pixel, std::uint64_t sample);

}  // namespace tessera::vulkan

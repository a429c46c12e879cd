#pragma once

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/gpu_scene.h"
#include "mediator/backend/backend.h"

namespace tessera::vulkan {

backend::BackendEntry entry();

// The same with settings of the device layer (for fault injection in tests) and a choice of BVH (for
// benchmarks). The cache folder is taken from `settings`.
std::unique_ptr<backend::Backend> make_backend(const backend::BackendSettings& settings,
                                               const DeviceSettings& device, Trees trees = Trees::Wide);

}  // namespace tessera::vulkan

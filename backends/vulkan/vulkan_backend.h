#pragma once

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/gpu_scene.h"
#include "mediator/backend/backend.h"

namespace tessera::vulkan {

backend::BackendEntry entry();

// The same with settings of the device layer, which tests make fail, and on the trees that benches compare.
// The cache folder is that of `settings`.
std::unique_ptr<backend::Backend> make_backend(const backend::BackendSettings& settings,
                                               const DeviceSettings& device, Trees trees = Trees::Wide);

}  // namespace tessera::vulkan

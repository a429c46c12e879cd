#pragma once

#include <memory>
#include <string>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/kernels.h"
#include "backends/vulkan/pace.h"
#include "backends/vulkan/raster/raster_kernels.h"
#include "backends/vulkan/raster/raster_target.h"
#include "mediator/backend/backend.h"

namespace tessera::vulkan {

// A device with all that lives no longer than it.
struct OpenedDevice {
    Instance instance;
    Device device;
    Kernels kernels;
    Pace pace, raster_pace;
    RasterKernels raster;
    RasterTargets targets;

    OpenedDevice(const std::string& wanted, const DeviceSettings& settings)
        : instance(settings.validation, settings.listener),
          device(instance, choose_device(list_devices(instance), wanted), settings),
          kernels(device),
          raster(device),
          targets(device) {}
};

// Opens the device that the settings name, again if need be. `threads` of the settings are those of a
// software device, for the whole process.
class DeviceOpener {
  public:
    DeviceOpener(const backend::BackendSettings& settings, const DeviceSettings& device);

    // Throws Error{Unavailable} or Error{InvalidInput} with the devices there are.
    std::unique_ptr<OpenedDevice> open() const;

  private:
    std::string wanted_;
    DeviceSettings settings_;
};

}  // namespace tessera::vulkan

#pragma once

#include <memory>
#include <string>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/dispatch_budget.h"
#include "backends/vulkan/kernels.h"
#include "backends/vulkan/raster/raster_kernels.h"
#include "backends/vulkan/raster/raster_target.h"
#include "mediator/backend/backend.h"

namespace tessera::vulkan {

// A device and everything that has its lifetime.
struct OpenedDevice {
    Instance instance;
    Device device;
    Kernels kernels;
    DispatchBudget dispatch_budget, raster_dispatch_budget;
    RasterKernels raster;
    RasterTargets targets;

    OpenedDevice(const std::string& wanted, const DeviceSettings& settings)
        : instance(settings.validation, settings.listener),
          device(instance, choose_device(list_devices(instance), wanted), settings),
          kernels(device),
          raster(device),
          targets(device) {}
};

// Opens (and reopens) the device named by the settings. `threads` sets the threads of a software device, for
// the whole process.
class DeviceOpener {
  public:
    DeviceOpener(const backend::BackendSettings& settings, const DeviceSettings& device);

    // Throws Error{Unavailable} or Error{InvalidInput} with a list of the available devices.
    std::unique_ptr<OpenedDevice> open() const;

  private:
    std::string wanted_;
    DeviceSettings settings_;
};

}  // namespace tessera::vulkan

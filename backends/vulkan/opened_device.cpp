#include "backends/vulkan/opened_device.h"

#include <cstdlib>

namespace tessera::vulkan {

DeviceOpener::DeviceOpener(const backend::BackendSettings& settings, const DeviceSettings& device)
    : wanted_(settings.device), settings_(device) {
    settings_.cache_folder = settings.cache_folder;
    // lavapipe reads this variable when the device is opened.
    if (settings.threads != 0) ::setenv("LP_NUM_THREADS", std::to_string(settings.threads).c_str(), 0);
}

std::unique_ptr<OpenedDevice> DeviceOpener::open() const {
    return std::make_unique<OpenedDevice>(wanted_, settings_);
}

}  // namespace tessera::vulkan

#pragma once

#include <string>
#include <vector>

#include "mediator/base/error.h"

namespace tessera::tools {

struct VulkanDevice {
    std::string name;
    std::string kind;         // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"
    std::string api_version;  // "1.3.230"
};

// Asks the loader, which is opened at run time: a machine without Vulkan is a normal one. Unavailable: no
// loader or no driver, with the remedy.
Expected<std::vector<VulkanDevice>> vulkan_devices();

}  // namespace tessera::tools

#pragma once

#include <vulkan/vulkan_core.h>

#include <string>
#include <vector>

namespace tessera::vulkan {

// The features of core Vulkan 1.3 as one chain, to be asked for or to be filled by the driver.
class FeatureChain final {
  public:
    FeatureChain();
    FeatureChain(const FeatureChain&) = delete;
    FeatureChain& operator=(const FeatureChain&) = delete;

    VkPhysicalDeviceFeatures2* head() { return &core; }

    VkPhysicalDeviceFeatures2 core{};
    VkPhysicalDeviceVulkan11Features v11{};
    VkPhysicalDeviceVulkan12Features v12{};
    VkPhysicalDeviceVulkan13Features v13{};
};

// What this device lacks of what the shaders and this layer need, one phrase each; empty for a device that
// can be used. The device is of Vulkan 1.3.
std::vector<std::string> missing_features(VkPhysicalDevice device);

// Whether one call can make many indirect draws, each of instances of its own.
bool offers_draw_lists(VkPhysicalDevice device);

// Switches on exactly what is needed, and draw lists where they are offered.
void require_features(FeatureChain& chain, VkPhysicalDevice device);

}  // namespace tessera::vulkan

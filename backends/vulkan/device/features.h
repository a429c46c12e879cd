#pragma once

#include <vulkan/vulkan_core.h>

#include <string>
#include <vector>

namespace tessera::vulkan {

// The features of core Vulkan 1.3 as one pNext chain, to be requested or to be filled by the driver.
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

// The required features that this device lacks, one phrase each; empty for a usable device. The device must
// support Vulkan 1.3.
std::vector<std::string> missing_features(VkPhysicalDevice device);

// Whether one call can issue several indirect draws, each with its own first instance.
bool offers_draw_lists(VkPhysicalDevice device);

// Enables exactly the required features, and draw lists if supported.
void require_features(FeatureChain& chain, VkPhysicalDevice device);

}  // namespace tessera::vulkan

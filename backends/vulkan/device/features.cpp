#include "backends/vulkan/device/features.h"

#include <array>

namespace tessera::vulkan {

namespace {

struct Requirement {
    const char* name;
    const char* use;
    VkBool32& (*field)(FeatureChain&);
};

constexpr std::array Requirements{
    Requirement{"shaderInt64", "addresses and sample indices",
                [](FeatureChain& f) -> VkBool32& { return f.core.features.shaderInt64; }},
    Requirement{"shaderInt8", "quantised boxes",
                [](FeatureChain& f) -> VkBool32& { return f.v12.shaderInt8; }},
    Requirement{"storageBuffer8BitAccess", "quantised boxes and texels",
                [](FeatureChain& f) -> VkBool32& { return f.v12.storageBuffer8BitAccess; }},
    Requirement{"storageBuffer16BitAccess", "texels",
                [](FeatureChain& f) -> VkBool32& { return f.v11.storageBuffer16BitAccess; }},
    Requirement{"bufferDeviceAddress", "buffers beyond the storage range",
                [](FeatureChain& f) -> VkBool32& { return f.v12.bufferDeviceAddress; }},
    Requirement{"scalarBlockLayout", "layouts shared with C++",
                [](FeatureChain& f) -> VkBool32& { return f.v12.scalarBlockLayout; }},
    Requirement{"timelineSemaphore", "waiting for dispatches",
                [](FeatureChain& f) -> VkBool32& { return f.v12.timelineSemaphore; }},
    Requirement{"vulkanMemoryModel", "queues between workgroups",
                [](FeatureChain& f) -> VkBool32& { return f.v12.vulkanMemoryModel; }},
    Requirement{"vulkanMemoryModelDeviceScope", "queues between workgroups",
                [](FeatureChain& f) -> VkBool32& { return f.v12.vulkanMemoryModelDeviceScope; }},
    Requirement{"hostQueryReset", "times of dispatches",
                [](FeatureChain& f) -> VkBool32& { return f.v12.hostQueryReset; }},
    Requirement{"synchronization2", "barriers",
                [](FeatureChain& f) -> VkBool32& { return f.v13.synchronization2; }},
    Requirement{"maintenance4", "workgroup sizes as specialisation constants",
                [](FeatureChain& f) -> VkBool32& { return f.v13.maintenance4; }},
    Requirement{"dynamicRendering", "drawing without render passes",
                [](FeatureChain& f) -> VkBool32& { return f.v13.dynamicRendering; }},
};

}  // namespace

FeatureChain::FeatureChain() {
    core.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2;
    core.pNext = &v11;
    v11.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES;
    v11.pNext = &v12;
    v12.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES;
    v12.pNext = &v13;
    v13.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES;
}

std::vector<std::string> missing_features(VkPhysicalDevice device) {
    FeatureChain offered;
    vkGetPhysicalDeviceFeatures2(device, offered.head());
    std::vector<std::string> missing;
    for (const Requirement& requirement : Requirements) {
        if (requirement.field(offered) == VK_FALSE) {
            missing.push_back("no " + std::string(requirement.name) + " (" + requirement.use + ")");
        }
    }
    return missing;
}

bool offers_draw_lists(VkPhysicalDevice device) {
    FeatureChain offered;
    vkGetPhysicalDeviceFeatures2(device, offered.head());
    const VkPhysicalDeviceFeatures& core = offered.core.features;
    return core.multiDrawIndirect == VK_TRUE && core.drawIndirectFirstInstance == VK_TRUE;
}

void require_features(FeatureChain& chain, VkPhysicalDevice device) {
    for (const Requirement& requirement : Requirements) requirement.field(chain) = VK_TRUE;
    const VkBool32 lists = offers_draw_lists(device) ? VK_TRUE : VK_FALSE;
    chain.core.features.multiDrawIndirect = chain.core.features.drawIndirectFirstInstance = lists;
}

}  // namespace tessera::vulkan

#include "backends/vulkan/device/device.h"

#include <vector>

#include "backends/vulkan/device/features.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

// One queue family for everything, preferably with graphics, so that rasterised and traced pictures need no
// ownership transfer between queues.
std::uint32_t choose_family(VkPhysicalDevice device) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    constexpr VkQueueFlags Both = VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT;
    for (const VkQueueFlags wanted : {Both, VkQueueFlags(VK_QUEUE_COMPUTE_BIT)}) {
        for (std::uint32_t i = 0; i < count; ++i) {
            if ((families[i].queueFlags & wanted) == wanted) return i;
        }
    }
    throw Error(ErrorCode::Internal, "the device has no compute queue; report this");
}

VkDevice open(const DeviceInfo& info, std::uint32_t family) {
    FeatureChain features;
    require_features(features, info.handle);
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue{.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                        .queueFamilyIndex = family,
                                        .queueCount = 1,
                                        .pQueuePriorities = &priority};
    std::vector<const char*> extensions;
    if (info.memory_budget) extensions.push_back(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
    const VkDeviceCreateInfo create{.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                    .pNext = features.head(),
                                    .queueCreateInfoCount = 1,
                                    .pQueueCreateInfos = &queue,
                                    .enabledExtensionCount = static_cast<std::uint32_t>(extensions.size()),
                                    .ppEnabledExtensionNames = extensions.data()};
    VkDevice device = VK_NULL_HANDLE;
    check(vkCreateDevice(info.handle, &create, nullptr, &device), "open the device " + info.name);
    return device;
}

}  // namespace

Device::Opened::~Opened() {
    vkDestroyDevice(object, nullptr);
}

Device::Device(const Instance&, const DeviceInfo& info, const DeviceSettings& settings)
    : info_(info),
      buffer_slack_(settings.buffer_slack),
      family_(choose_family(info.handle)),
      device_{open(info, family_)},
      memory_(device_.object, info_, settings.memory),
      queue_(device_.object, info_, family_, settings.fault),
      pipelines_(device_.object, info_, settings.cache_folder) {}

Device::~Device() = default;

Allocation Device::allocate(const VkMemoryRequirements& needs, MemoryKind kind) {
    queue_.collect();
    try {
        return memory_.allocate(needs, kind);
    } catch (const Error& error) {
        if (error.code() != ErrorCode::OutOfMemory) throw;
    }
    queue_.latest().wait();  // memory of dropped buffers is released now
    queue_.collect();
    return memory_.allocate(needs, kind);
}

}  // namespace tessera::vulkan

#include "backends/vulkan/device/device_list.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>

#include "backends/vulkan/device/features.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

DeviceKind kind_of(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return DeviceKind::Discrete;
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return DeviceKind::Integrated;
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return DeviceKind::Virtual;
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return DeviceKind::Cpu;
        default:
            return DeviceKind::Other;
    }
}

std::set<std::string> extensions_of(VkPhysicalDevice device) {
    std::uint32_t count = 0;
    check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, nullptr), "list device extensions");
    std::vector<VkExtensionProperties> list(count);
    check(vkEnumerateDeviceExtensionProperties(device, nullptr, &count, list.data()),
          "list device extensions");
    std::set<std::string> names;
    for (const VkExtensionProperties& extension : list) names.insert(extension.extensionName);
    return names;
}

bool has_queue(VkPhysicalDevice device, VkQueueFlags wanted) {
    std::uint32_t count = 0;
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
    std::vector<VkQueueFamilyProperties> families(count);
    vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());
    return std::any_of(families.begin(), families.end(), [wanted](const VkQueueFamilyProperties& family) {
        return (family.queueFlags & wanted) == wanted;
    });
}

// Every device with graphics supports the colour formats that are drawn to.
bool can_draw(VkPhysicalDevice device) {
    VkFormatProperties depth{};
    vkGetPhysicalDeviceFormatProperties(device, VK_FORMAT_D32_SFLOAT, &depth);
    return has_queue(device, VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT) &&
           (depth.optimalTilingFeatures & VK_FORMAT_FEATURE_DEPTH_STENCIL_ATTACHMENT_BIT) != 0 &&
           (depth.optimalTilingFeatures & VK_FORMAT_FEATURE_TRANSFER_SRC_BIT) != 0;
}

void read_limits(DeviceInfo& info, const VkPhysicalDeviceLimits& limits) {
    info.max_workgroup_size = limits.maxComputeWorkGroupInvocations;
    info.max_groups = *std::min_element(std::begin(limits.maxComputeWorkGroupCount),
                                        std::end(limits.maxComputeWorkGroupCount));
    info.shared_memory_bytes = limits.maxComputeSharedMemorySize;
    info.push_constant_bytes = limits.maxPushConstantsSize;
    info.storage_range_bytes = limits.maxStorageBufferRange;
    info.texel_elements = limits.maxTexelBufferElements;
    info.max_allocations = limits.maxMemoryAllocationCount;
    info.image_edge =
        std::min({limits.maxImageDimension2D, limits.maxFramebufferWidth, limits.maxFramebufferHeight,
                  limits.maxViewportDimensions[0], limits.maxViewportDimensions[1]});
    info.image_granularity = limits.bufferImageGranularity;
    info.timestamp_period = limits.timestampComputeAndGraphics != VK_FALSE ? limits.timestampPeriod : 0.0f;
}

void read_memory(DeviceInfo& info) {
    VkPhysicalDeviceMemoryProperties memory{};
    vkGetPhysicalDeviceMemoryProperties(info.handle, &memory);
    for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i) {
        if ((memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) != 0) {
            info.device_memory_bytes = std::max(info.device_memory_bytes, memory.memoryHeaps[i].size);
        }
    }
    constexpr VkMemoryPropertyFlags Unified =
        VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT | VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT |
        VK_MEMORY_PROPERTY_HOST_COHERENT_BIT | VK_MEMORY_PROPERTY_HOST_CACHED_BIT;
    for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i) {
        if ((memory.memoryTypes[i].propertyFlags & Unified) == Unified) info.unified_memory = true;
    }
}

// Queries that need Vulkan 1.3.
void read_core_1_3(DeviceInfo& info) {
    VkPhysicalDeviceVulkan13Properties v13{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_PROPERTIES};
    VkPhysicalDeviceVulkan12Properties v12{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES,
                                           .pNext = &v13};
    VkPhysicalDeviceVulkan11Properties v11{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES,
                                           .pNext = &v12};
    VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                           .pNext = &v11};
    vkGetPhysicalDeviceProperties2(info.handle, &properties);
    info.driver = std::string(v12.driverName) + " " + v12.driverInfo;
    info.subgroup_size = v11.subgroupSize;
    info.min_subgroup_size = v13.minSubgroupSize;
    info.max_subgroup_size = v13.maxSubgroupSize;
    info.buffer_bytes = v13.maxBufferSize;
    info.allocation_bytes = v11.maxMemoryAllocationSize;
    info.supports_denormals = v12.shaderDenormPreserveFloat32 != VK_FALSE;
    info.supports_round_to_even = v12.shaderRoundingModeRTEFloat32 != VK_FALSE;
    const std::set<std::string> extensions = extensions_of(info.handle);
    info.ray_query = extensions.contains(VK_KHR_RAY_QUERY_EXTENSION_NAME) &&
                     extensions.contains(VK_KHR_ACCELERATION_STRUCTURE_EXTENSION_NAME);
    info.memory_budget = extensions.contains(VK_EXT_MEMORY_BUDGET_EXTENSION_NAME);
}

DeviceInfo describe(VkPhysicalDevice handle, std::uint32_t index) {
    VkPhysicalDeviceProperties properties{};
    vkGetPhysicalDeviceProperties(handle, &properties);
    DeviceInfo info{.index = index,
                    .name = properties.deviceName,
                    .kind = kind_of(properties.deviceType),
                    .api_version = properties.apiVersion,
                    .driver = "version " + std::to_string(properties.driverVersion),
                    .vendor_id = properties.vendorID,
                    .device_id = properties.deviceID,
                    .driver_version = properties.driverVersion};
    info.handle = handle;
    std::copy(std::begin(properties.pipelineCacheUUID), std::end(properties.pipelineCacheUUID),
              info.cache_uuid.begin());
    read_limits(info, properties.limits);
    read_memory(info);
    if (properties.apiVersion < VK_API_VERSION_1_3) {
        info.refused.push_back("Vulkan " + version_text(properties.apiVersion) +
                               ", but 1.3 is required: update the driver");
        return info;
    }
    read_core_1_3(info);
    info.refused = missing_features(handle);
    info.draws = can_draw(handle);
    if (offers_draw_lists(handle)) info.draws_per_call = properties.limits.maxDrawIndirectCount;
    if (!has_queue(handle, VK_QUEUE_COMPUTE_BIT)) info.refused.push_back("no compute queue");
    return info;
}

std::string lower_case(std::string_view text) {
    std::string result(text);
    for (char& letter : result) letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return result;
}

bool is_meant(const DeviceInfo& device, std::string_view wanted) {
    std::uint32_t index = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), index);
    if (error == std::errc{} && end == wanted.data() + wanted.size()) return device.index == index;
    return lower_case(device.name).find(lower_case(wanted)) != std::string::npos;
}

std::string listing(std::span<const DeviceInfo> devices) {
    if (devices.empty()) return "none found: install mesa-vulkan-drivers or the GPU maker's driver";
    std::string text;
    for (const DeviceInfo& device : devices) {
        text += (text.empty() ? "" : "; ") + std::to_string(device.index) + " = " + device.name + " (" +
                kind_name(device.kind) + ")";
        for (std::size_t i = 0; i < device.refused.size(); ++i) {
            text += (i == 0 ? ", refused: " : ", ") + device.refused[i];
        }
    }
    return text;
}

}  // namespace

const char* kind_name(DeviceKind kind) {
    constexpr std::array Names{"discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"};
    return Names[static_cast<std::size_t>(kind)];
}

std::string version_text(std::uint32_t packed) {
    return std::to_string(VK_API_VERSION_MAJOR(packed)) + "." + std::to_string(VK_API_VERSION_MINOR(packed)) +
           "." + std::to_string(VK_API_VERSION_PATCH(packed));
}

std::vector<DeviceInfo> list_devices(const Instance& instance) {
    std::uint32_t count = 0;
    check(vkEnumeratePhysicalDevices(instance.get(), &count, nullptr), "list Vulkan devices");
    std::vector<VkPhysicalDevice> handles(count);
    check(vkEnumeratePhysicalDevices(instance.get(), &count, handles.data()), "list Vulkan devices");
    std::vector<DeviceInfo> devices;
    for (std::uint32_t i = 0; i < count; ++i) devices.push_back(describe(handles[i], i));
    return devices;
}

const DeviceInfo& choose_device(std::span<const DeviceInfo> devices, std::string_view wanted) {
    const DeviceInfo* best = nullptr;
    for (const DeviceInfo& device : devices) {
        if (!device.refused.empty() || !is_meant(device, wanted)) continue;
        if (best == nullptr || device.kind < best->kind) best = &device;
    }
    if (best != nullptr) return *best;
    if (wanted.empty()) {
        throw Error(ErrorCode::Unavailable, "no Vulkan device can be used: " + listing(devices));
    }
    throw Error(ErrorCode::InvalidInput, "no usable Vulkan device matches '" + std::string(wanted) +
                                             "'; give an index or part of a name: " + listing(devices));
}

}  // namespace tessera::vulkan

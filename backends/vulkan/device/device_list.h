#pragma once

#include <vulkan/vulkan_core.h>

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "backends/vulkan/device/instance.h"

namespace tessera::vulkan {

enum class DeviceKind { Discrete, Integrated, Virtual, Cpu, Other };  // best first

const char* kind_name(DeviceKind kind);  // "discrete GPU", "integrated GPU", "virtual GPU", "CPU", "other"

// What a device says about itself. Limits are read, never assumed.
struct DeviceInfo {
    std::uint32_t index = 0;  // in the driver's order: what --device INDEX means
    std::string name;
    DeviceKind kind = DeviceKind::Other;
    std::uint32_t api_version = 0;  // as Vulkan packs it
    std::string driver;             // name and version
    std::uint32_t vendor_id = 0, device_id = 0, driver_version = 0;
    std::array<std::uint8_t, 16> cache_uuid{};  // compiled pipelines are good for this device and driver only

    std::uint32_t subgroup_size = 0, min_subgroup_size = 0, max_subgroup_size = 0;
    std::uint32_t max_workgroup_size = 0;   // invocations
    std::uint32_t max_groups = 0;           // of a dispatch, per axis; the smallest of the three
    std::uint32_t shared_memory_bytes = 0;  // of a workgroup
    std::uint32_t push_constant_bytes = 0;
    std::uint64_t storage_range_bytes = 0;  // of a descriptor; addresses reach further
    std::uint64_t texel_elements = 0;       // of a binding to texels
    std::uint64_t buffer_bytes = 0;         // of one buffer
    std::uint64_t allocation_bytes = 0;     // of one allocation
    std::uint32_t max_allocations = 0;
    std::uint32_t image_edge = 0;           // pixels of an image, per axis
    std::uint64_t image_granularity = 0;    // bytes that images keep from buffers
    std::uint32_t draws_per_call = 1;       // indirect draws, each of instances of its own
    std::uint64_t device_memory_bytes = 0;  // the largest device-local heap
    bool unified_memory = false;            // device-local memory is host-visible and cached
    float timestamp_period = 0;             // nanoseconds per tick; 0 = no timestamps

    bool keeps_denormals = false;  // a shader may demand it of 32-bit floats
    bool rounds_to_even = false;   // likewise
    bool draws = false;            // has a graphics pipeline, with depth as 32-bit floats
    bool ray_query = false;        // with acceleration structures
    bool memory_budget = false;    // VK_EXT_memory_budget

    std::vector<std::string> refused;  // why it cannot be used; empty = it can
    VkPhysicalDevice handle = VK_NULL_HANDLE;
};

std::string version_text(std::uint32_t packed);  // "1.3.230"

// All devices in the driver's order, also those that are refused.
std::vector<DeviceInfo> list_devices(const Instance& instance);

// The device that `wanted` means: "" = the best that is not refused (discrete before integrated before
// virtual before CPU; the first among equals), a number = the index, else the best whose name contains the
// text, letter case aside. Throws Error{InvalidInput} for a wish that fits none or only a refused one,
// Error{Unavailable} when nothing can be used; both list the devices and why they were refused.
const DeviceInfo& choose_device(std::span<const DeviceInfo> devices, std::string_view wanted);

}  // namespace tessera::vulkan

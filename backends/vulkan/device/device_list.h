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

// Properties of a device, as its driver reports them.
struct DeviceInfo {
    std::uint32_t index = 0;  // in the driver's order, as in --device INDEX
    std::string name;
    DeviceKind kind = DeviceKind::Other;
    std::uint32_t api_version = 0;  // as Vulkan packs it
    std::string driver;             // name and version
    std::uint32_t vendor_id = 0, device_id = 0, driver_version = 0;
    std::array<std::uint8_t, 16>
        cache_uuid{};  // compiled pipelines are valid for this device and driver only

    std::uint32_t subgroup_size = 0, min_subgroup_size = 0, max_subgroup_size = 0;
    std::uint32_t max_workgroup_size = 0;   // invocations
    std::uint32_t max_groups = 0;           // of a dispatch, per axis; the smallest of the three
    std::uint32_t shared_memory_bytes = 0;  // of a workgroup
    std::uint32_t push_constant_bytes = 0;
    std::uint64_t storage_range_bytes = 0;  // of a descriptor; addresses have no such limit
    std::uint64_t texel_elements = 0;       // of a texel buffer binding
    std::uint64_t buffer_bytes = 0;         // of one buffer
    std::uint64_t allocation_bytes = 0;     // of one allocation
    std::uint32_t max_allocations = 0;
    std::uint32_t image_edge = 0;           // maximum pixels of an image, per axis
    std::uint64_t image_granularity = 0;    // minimum distance in bytes between images and buffers
    std::uint32_t draws_per_call = 1;       // indirect draws per call, each with its own first instance
    std::uint64_t device_memory_bytes = 0;  // the largest device-local heap
    bool unified_memory = false;            // device-local memory is host-visible and cached
    float timestamp_period = 0;             // nanoseconds per tick; 0 = no timestamps

    bool supports_denormals = false;      // shaders may require denormals of 32-bit floats
    bool supports_round_to_even = false;  // likewise, round to nearest even
    bool draws = false;                   // supports graphics, with 32-bit float depth
    bool ray_query = false;               // with acceleration structures
    bool memory_budget = false;           // VK_EXT_memory_budget

    std::vector<std::string> refused;  // why it cannot be used; empty if it can
    VkPhysicalDevice handle = VK_NULL_HANDLE;
};

std::string version_text(std::uint32_t packed);  // "1.3.230"

// All devices in the driver's order, including unusable ones.
std::vector<DeviceInfo> list_devices(const Instance& instance);

// The device selected by `wanted`: "" = the best usable one (discrete before integrated before virtual before
// CPU; the first among equals), a number = the index, otherwise the best whose name contains the text, ignoring
// case. Throws Error{InvalidInput} if no usable device matches, Error{Unavailable} if none is usable at all; both
// list the devices and why they cannot be used.
const DeviceInfo& choose_device(std::span<const DeviceInfo> devices, std::string_view wanted);

}  // namespace tessera::vulkan

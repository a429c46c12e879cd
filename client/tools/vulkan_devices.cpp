#include "client/tools/vulkan_devices.h"

#ifdef TESSERA_BACKEND_VULKAN
#include "backends/vulkan/device/device_list.h"
#include "mediator/base/error.h"
#endif

namespace tessera::tools {

#ifdef TESSERA_BACKEND_VULKAN

namespace {

Diagnostic describe(const vulkan::DeviceInfo& device) {
    std::string refusals;
    for (const std::string& reason : device.refused) refusals += (refusals.empty() ? "" : ", ") + reason;
    Diagnostic diagnostic{.severity = device.refused.empty() ? Severity::Ok : Severity::Warning,
                          .subject = "Vulkan device " + std::to_string(device.index),
                          .fact = device.name + " (" + vulkan::kind_name(device.kind) + ")",
                          .remedy = refusals.empty() ? "" : "refused: " + refusals};
    diagnostic.facts = {
        {"vulkan", vulkan::version_text(device.api_version)},
        {"driver", device.driver},
        {"memory_bytes", device.device_memory_bytes},
        {"unified_memory", device.unified_memory},
        {"subgroup_size", std::uint64_t(device.subgroup_size)},
        {"min_subgroup_size", std::uint64_t(device.min_subgroup_size)},
        {"max_subgroup_size", std::uint64_t(device.max_subgroup_size)},
        {"workgroup_invocations", std::uint64_t(device.max_workgroup_size)},
        {"shared_memory_bytes", std::uint64_t(device.shared_memory_bytes)},
        {"push_constant_bytes", std::uint64_t(device.push_constant_bytes)},
        {"buffer_bytes", device.buffer_bytes},
        {"allocation_bytes", device.allocation_bytes},
        {"timestamps", device.timestamp_period > 0},
        {"keeps_denormals", device.supports_denormals},
        {"rounds_to_even", device.supports_round_to_even},
        {"memory_budget", device.memory_budget},
        {"ray_query", device.ray_query},
        {"draws", device.draws},
    };
    return diagnostic;
}

}  // namespace

void examine_vulkan(Diagnostics& diagnostics) {
    try {
        const vulkan::Instance instance;
        const auto devices = vulkan::list_devices(instance);
        for (const vulkan::DeviceInfo& device : devices) diagnostics.push_back(describe(device));
        if (devices.empty()) {
            diagnostics.push_back({Severity::Warning, "Vulkan", "no device",
                                   "install mesa-vulkan-drivers or the GPU maker's driver"});
        }
    } catch (const Error& error) {
        diagnostics.push_back({Severity::Warning, "Vulkan", "none", error.what()});
    }
}

#else

void examine_vulkan(Diagnostics& diagnostics) {
    diagnostics.push_back({Severity::Warning, "Vulkan", "not built",
                           "install libvulkan-dev, glslc and spirv-tools and configure with "
                           "-DTESSERA_BACKEND_VULKAN=ON"});
}

#endif

}  // namespace tessera::tools

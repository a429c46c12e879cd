#include "mediator/backend/catalog.h"

#include <algorithm>
#include <array>

#include "backends/null/null_backend.h"
#ifdef TESSERA_BACKEND_EMBREE
#include "backends/embree/embree_backend.h"
#endif
#ifdef TESSERA_BACKEND_VULKAN
#include "backends/vulkan/vulkan_backend.h"
#endif

namespace tessera::backend {

std::span<const BackendEntry> catalog() {
    static const std::array entries{
#ifdef TESSERA_BACKEND_EMBREE
        embree::entry(),
#endif
#ifdef TESSERA_BACKEND_VULKAN
        vulkan::entry(),
#endif
        null_backend::entry(),
    };
    return entries;
}

const BackendEntry& find_backend(std::string_view name) {
    const std::span<const BackendEntry> entries = catalog();
    const auto found = std::find_if(entries.begin(), entries.end(),
                                    [&](const BackendEntry& entry) { return entry.name == name; });
    if (found != entries.end()) return *found;
    std::string names;
    for (const BackendEntry& entry : entries) names += (names.empty() ? "" : ", ") + entry.name;
    throw Error(ErrorCode::InvalidInput,
                "unknown back-end '" + std::string(name) + "'; choose one of " + names);
}

bool has_device_choice() {
    const std::span<const BackendEntry> entries = catalog();
    return std::any_of(entries.begin(), entries.end(),
                       [](const BackendEntry& entry) { return entry.chooses_device; });
}

Expected<void> check_device(const BackendEntry& entry, std::string_view device) {
    if (device.empty() || entry.chooses_device) return {};
    return failure(ErrorCode::InvalidInput,
                   "back-end '" + entry.name + "' does not support device selection: omit --device");
}

}  // namespace tessera::backend

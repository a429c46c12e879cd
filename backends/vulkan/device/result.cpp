#include "backends/vulkan/device/result.h"

#include <array>
#include <utility>

namespace tessera::vulkan {

namespace {

struct Meaning {
    VkResult result;
    const char* name;
    ErrorCode code;
    const char* remedy;
};

constexpr const char* MissingPart =
    "the driver lacks a requested feature: see 'tessera doctor' for what it supports";
constexpr std::array Meanings{
    Meaning{VK_NOT_READY, "VK_NOT_READY", ErrorCode::Unavailable, "try again"},
    Meaning{VK_TIMEOUT, "VK_TIMEOUT", ErrorCode::Unavailable, "try again"},
    Meaning{VK_INCOMPLETE, "VK_INCOMPLETE", ErrorCode::Internal, "report this"},
    Meaning{VK_ERROR_OUT_OF_HOST_MEMORY, "VK_ERROR_OUT_OF_HOST_MEMORY", ErrorCode::OutOfMemory,
            "free memory on this machine"},
    Meaning{VK_ERROR_OUT_OF_DEVICE_MEMORY, "VK_ERROR_OUT_OF_DEVICE_MEMORY", ErrorCode::OutOfMemory,
            "use a smaller scene or a device with more memory"},
    Meaning{VK_ERROR_INITIALIZATION_FAILED, "VK_ERROR_INITIALIZATION_FAILED", ErrorCode::Unavailable,
            "check the driver's installation with vulkaninfo"},
    Meaning{VK_ERROR_DEVICE_LOST, "VK_ERROR_DEVICE_LOST", ErrorCode::Unavailable,
            "the device has to be reopened"},
    Meaning{VK_ERROR_MEMORY_MAP_FAILED, "VK_ERROR_MEMORY_MAP_FAILED", ErrorCode::OutOfMemory,
            "free address space or memory on this machine"},
    Meaning{VK_ERROR_LAYER_NOT_PRESENT, "VK_ERROR_LAYER_NOT_PRESENT", ErrorCode::Unavailable,
            "install vulkan-validationlayers"},
    Meaning{VK_ERROR_EXTENSION_NOT_PRESENT, "VK_ERROR_EXTENSION_NOT_PRESENT", ErrorCode::Unavailable,
            MissingPart},
    Meaning{VK_ERROR_FEATURE_NOT_PRESENT, "VK_ERROR_FEATURE_NOT_PRESENT", ErrorCode::Unavailable,
            MissingPart},
    Meaning{VK_ERROR_INCOMPATIBLE_DRIVER, "VK_ERROR_INCOMPATIBLE_DRIVER", ErrorCode::Unavailable,
            "install mesa-vulkan-drivers or the GPU maker's driver"},
    Meaning{VK_ERROR_TOO_MANY_OBJECTS, "VK_ERROR_TOO_MANY_OBJECTS", ErrorCode::OutOfMemory,
            "the driver allows no more objects of this kind: close other programs on the device"},
    Meaning{VK_ERROR_OUT_OF_POOL_MEMORY, "VK_ERROR_OUT_OF_POOL_MEMORY", ErrorCode::OutOfMemory,
            "report this"},
    Meaning{VK_ERROR_FRAGMENTATION, "VK_ERROR_FRAGMENTATION", ErrorCode::OutOfMemory, "restart the program"},
    Meaning{VK_ERROR_UNKNOWN, "VK_ERROR_UNKNOWN", ErrorCode::Internal, "check the driver's log"},
};

const Meaning* find_meaning(VkResult result) {
    for (const Meaning& meaning : Meanings) {
        if (meaning.result == result) return &meaning;
    }
    return nullptr;
}

}  // namespace

std::string result_name(VkResult result) {
    if (result == VK_SUCCESS) return "VK_SUCCESS";
    const Meaning* meaning = find_meaning(result);
    return meaning != nullptr ? meaning->name : "VkResult " + std::to_string(int(result));
}

void check(VkResult result, std::string_view operation) {
    if (result == VK_SUCCESS) return;
    const Meaning* meaning = find_meaning(result);
    const std::string message = "cannot " + std::string(operation) + ": " + result_name(result) + "; " +
                                (meaning != nullptr ? meaning->remedy : "check the driver's log");
    if (result == VK_ERROR_DEVICE_LOST) throw DeviceLost(message);
    throw Error(meaning != nullptr ? meaning->code : ErrorCode::Internal, message);
}

}  // namespace tessera::vulkan

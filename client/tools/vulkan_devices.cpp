#include "client/tools/vulkan_devices.h"

#include <dlfcn.h>

#if __has_include(<vulkan/vulkan_core.h>)
#include <vulkan/vulkan_core.h>

#include <memory>

namespace tessera::tools {

namespace {

struct CloseLibrary {
    void operator()(void* library) const { ::dlclose(library); }
};
using Library = std::unique_ptr<void, CloseLibrary>;

std::string kind_of(VkPhysicalDeviceType type) {
    switch (type) {
        case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
            return "discrete GPU";
        case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
            return "integrated GPU";
        case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
            return "virtual GPU";
        case VK_PHYSICAL_DEVICE_TYPE_CPU:
            return "CPU";
        default:
            return "other";
    }
}

std::string version_text(std::uint32_t version) {
    return std::to_string(VK_API_VERSION_MAJOR(version)) + "." +
           std::to_string(VK_API_VERSION_MINOR(version)) + "." +
           std::to_string(VK_API_VERSION_PATCH(version));
}

tl::unexpected<Error> no_driver() {
    return failure(ErrorCode::Unavailable,
                   "no Vulkan driver: install mesa-vulkan-drivers or the GPU maker's driver");
}

}  // namespace

Expected<std::vector<VulkanDevice>> vulkan_devices() {
    const Library loader(::dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL));
    if (!loader) return failure(ErrorCode::Unavailable, "no Vulkan loader: install libvulkan1");
    const auto get =
        reinterpret_cast<PFN_vkGetInstanceProcAddr>(::dlsym(loader.get(), "vkGetInstanceProcAddr"));
    if (get == nullptr)
        return failure(ErrorCode::Unavailable, "libvulkan.so.1 is no Vulkan loader: reinstall libvulkan1");
    const auto create = reinterpret_cast<PFN_vkCreateInstance>(get(VK_NULL_HANDLE, "vkCreateInstance"));
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .apiVersion = VK_API_VERSION_1_1};
    const VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                    .pApplicationInfo = &application};
    VkInstance instance = VK_NULL_HANDLE;
    if (create == nullptr || create(&info, nullptr, &instance) != VK_SUCCESS) return no_driver();

    const auto destroy = reinterpret_cast<PFN_vkDestroyInstance>(get(instance, "vkDestroyInstance"));
    const auto enumerate =
        reinterpret_cast<PFN_vkEnumeratePhysicalDevices>(get(instance, "vkEnumeratePhysicalDevices"));
    const auto properties_of =
        reinterpret_cast<PFN_vkGetPhysicalDeviceProperties>(get(instance, "vkGetPhysicalDeviceProperties"));
    std::uint32_t count = 0;
    enumerate(instance, &count, nullptr);
    std::vector<VkPhysicalDevice> handles(count);
    enumerate(instance, &count, handles.data());
    std::vector<VulkanDevice> devices;
    for (std::uint32_t i = 0; i < count; ++i) {
        VkPhysicalDeviceProperties properties{};
        properties_of(handles[i], &properties);
        devices.push_back(
            {properties.deviceName, kind_of(properties.deviceType), version_text(properties.apiVersion)});
    }
    destroy(instance, nullptr);
    if (devices.empty()) return no_driver();
    return devices;
}

}  // namespace tessera::tools

#else

namespace tessera::tools {

Expected<std::vector<VulkanDevice>> vulkan_devices() {
    return failure(ErrorCode::Unavailable,
                   "built without Vulkan headers: install libvulkan-dev and build again");
}

}  // namespace tessera::tools

#endif

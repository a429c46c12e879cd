#include "backends/vulkan/device/instance.h"

#include <array>
#include <mutex>
#include <utility>

#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

struct Instance::Messages {
    MessageListener listener;
    std::mutex mutex;  // protects what follows
    std::vector<Message> list;
};

namespace {

constexpr const char* ValidationLayer = "VK_LAYER_KHRONOS_validation";
constexpr std::array ValidationExtensions{VK_EXT_DEBUG_UTILS_EXTENSION_NAME,
                                          VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME};

template <class Function>
Function find_function(VkInstance instance, const char* name) {
    return reinterpret_cast<Function>(vkGetInstanceProcAddr(instance, name));
}

// An instance that is never destroyed, so that the drivers stay loaded: NVIDIA's (580.159) takes thread-local storage
// each time it is loaded, and cannot be loaded for the 31st time. If this fails, so will the instance that is wanted.
void keep_drivers_loaded(const VkInstanceCreateInfo& info) {
    static const VkInstance kept = [&] {
        VkInstance instance = VK_NULL_HANDLE;
        vkCreateInstance(&info, nullptr, &instance);
        return instance;
    }();
    static_cast<void>(kept);
}

}  // namespace

Instance::Instance(Validation validation, MessageListener listener)
    : messages_(std::make_unique<Messages>()) {
    messages_->listener = std::move(listener);
    const VkApplicationInfo application{.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                        .pApplicationName = "tessera",
                                        .apiVersion = VK_API_VERSION_1_3};
    VkInstanceCreateInfo info{.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                              .pApplicationInfo = &application};
    keep_drivers_loaded(info);
    if (validation == Validation::None) {
        check(vkCreateInstance(&info, nullptr, &instance_), "create a Vulkan instance");
        return;
    }

    const auto collect = [](VkDebugUtilsMessageSeverityFlagBitsEXT severity, VkDebugUtilsMessageTypeFlagsEXT,
                            const VkDebugUtilsMessengerCallbackDataEXT* data, void* user) -> VkBool32 {
        auto& messages = *static_cast<Messages*>(user);
        const bool is_error = (severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) != 0;
        Message message{is_error ? Message::Severity::Error : Message::Severity::Warning,
                        data->pMessageIdName != nullptr ? data->pMessageIdName : "",
                        data->pMessage != nullptr ? data->pMessage : ""};
        if (messages.listener) {
            messages.listener(message);
            return VK_FALSE;
        }
        const std::scoped_lock lock(messages.mutex);
        messages.list.push_back(std::move(message));
        return VK_FALSE;
    };
    const VkDebugUtilsMessengerCreateInfoEXT messenger{
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType =
            VK_DEBUG_UTILS_MESSAGE_TYPE_GENERAL_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = collect,
        .pUserData = messages_.get()};
    std::vector<VkValidationFeatureEnableEXT> enabled{
        VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    if (validation == Validation::Instrumented) {
        enabled.push_back(VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT);
        enabled.push_back(VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT);
    }
    const VkValidationFeaturesEXT features{
        .sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
        .pNext = &messenger,
        .enabledValidationFeatureCount = static_cast<std::uint32_t>(enabled.size()),
        .pEnabledValidationFeatures = enabled.data()};
    info.pNext = &features;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &ValidationLayer;
    info.enabledExtensionCount = static_cast<std::uint32_t>(ValidationExtensions.size());
    info.ppEnabledExtensionNames = ValidationExtensions.data();
    check(vkCreateInstance(&info, nullptr, &instance_), "create a Vulkan instance with validation");
    const auto create =
        find_function<PFN_vkCreateDebugUtilsMessengerEXT>(instance_, "vkCreateDebugUtilsMessengerEXT");
    const VkResult created = create(instance_, &messenger, nullptr, &messenger_);
    if (created != VK_SUCCESS) vkDestroyInstance(instance_, nullptr);
    check(created, "create a debug messenger");
}

Instance::~Instance() {
    if (messenger_ != VK_NULL_HANDLE) {
        find_function<PFN_vkDestroyDebugUtilsMessengerEXT>(instance_, "vkDestroyDebugUtilsMessengerEXT")(
            instance_, messenger_, nullptr);
    }
    vkDestroyInstance(instance_, nullptr);
}

std::vector<Message> Instance::take_messages() {
    const std::scoped_lock lock(messages_->mutex);
    return std::exchange(messages_->list, {});
}

}  // namespace tessera::vulkan

#pragma once

#include <vulkan/vulkan_core.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tessera::vulkan {

// What the validation layer checks; anything but None needs the package vulkan-validationlayers.
enum class Validation {
    None,
    Calls,        // core checks and synchronization validation
    Instrumented  // also GPU-assisted: accesses out of bounds inside shaders; several times slower
};

struct Message {
    enum class Severity { Warning, Error };
    Severity severity = Severity::Error;
    std::string id;  // "VUID-..." or the layer's own name
    std::string text;
};

using MessageListener = std::function<void(const Message&)>;

// A Vulkan 1.3 instance without window system; its only extensions are those for validation messages. Outlives
// everything created from it. Throws Error{Unavailable} without a driver, or without a requested validation
// layer.
class Instance final {
  public:
    // Messages go to the listener, from any thread, or are stored if there is none.
    explicit Instance(Validation validation = Validation::None, MessageListener listener = {});
    ~Instance();
    Instance(const Instance&) = delete;
    Instance& operator=(const Instance&) = delete;

    VkInstance get() const { return instance_; }
    // Messages since the last call; always empty without validation. Thread-safe.
    std::vector<Message> take_messages();

  private:
    struct Messages;
    std::unique_ptr<Messages> messages_;
    VkInstance instance_ = VK_NULL_HANDLE;
    VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
};

}  // namespace tessera::vulkan

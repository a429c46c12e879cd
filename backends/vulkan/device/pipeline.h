#pragma once

#include <vulkan/vulkan_core.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace tessera::vulkan {

class Device;

// The value of one specialisation constant, as the bits of a 32-bit number.
struct Constant {
    std::uint32_t id = 0;
    std::uint32_t bits = 0;
};

// Descriptor set 0 of the shader: the buffers that a dispatch binds, in this order. Buffers accessed by address
// need no binding; but some devices read texels much faster (lavapipe: three times), and storage buffers a bit.
struct Binding {
    std::uint32_t index = 0;  // layout(set = 0, binding = index)
    enum class Kind {
        Storage,  // buffer { ... }; at most DeviceInfo::storage_range_bytes
        Texels    // uniform [iu]textureBuffer; at most DeviceInfo::texel_elements of `format`
    } kind = Kind::Storage;
    VkFormat format = VK_FORMAT_R32G32B32A32_UINT;  // of texels
};

struct PipelineSettings {
    std::string name;                     // for messages
    std::span<const std::uint32_t> code;  // SPIR-V, as tessera_shaders() embeds it; entry point "main"
    std::vector<Constant> constants;      // others keep the shader's defaults
    std::uint32_t push_bytes = 0;         // of the push-constant block
    std::vector<Binding> bindings;
};

// A compute pipeline. Destruction never waits, as for buffers. The device outlives it.
class ComputePipeline final {
  public:
    ComputePipeline() = default;  // cannot run
    // Throws Error if the driver rejects the code, or if push_bytes exceeds the device's limit.
    ComputePipeline(Device& device, const PipelineSettings& settings);
    ComputePipeline(ComputePipeline&& other) noexcept = default;
    ComputePipeline& operator=(ComputePipeline&& other) noexcept;
    ~ComputePipeline();

    VkPipeline get() const;
    VkPipelineLayout layout() const;
    VkDescriptorSetLayout set_layout() const;  // null without bindings
    const std::vector<Binding>& bindings() const { return bindings_; }
    std::uint32_t push_bytes() const { return push_bytes_; }
    const std::string& name() const { return name_; }

  private:
    struct Parts;
    Device* device_ = nullptr;
    std::shared_ptr<Parts> parts_;
    std::uint32_t push_bytes_ = 0;
    std::vector<Binding> bindings_;
    std::string name_;
};

}  // namespace tessera::vulkan

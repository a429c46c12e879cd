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

struct PipelineSettings {
    std::string name;                     // for messages
    std::span<const std::uint32_t> code;  // SPIR-V, as tessera_shaders() embeds it; entry point "main"
    std::vector<Constant> constants;      // those not named keep the shader's defaults
    std::uint32_t push_bytes = 0;         // of the push-constant block
};

// A kernel that is ready to run. Its end never waits, like a buffer's. The device outlives it.
class ComputePipeline final {
  public:
    ComputePipeline() = default;  // cannot run
    // Throws Error: the driver refuses the code, or push_bytes exceeds the device's limit.
    ComputePipeline(Device& device, const PipelineSettings& settings);
    ComputePipeline(ComputePipeline&& other) noexcept = default;
    ComputePipeline& operator=(ComputePipeline&& other) noexcept;
    ~ComputePipeline();

    VkPipeline get() const;
    VkPipelineLayout layout() const;
    std::uint32_t push_bytes() const { return push_bytes_; }
    const std::string& name() const { return name_; }

  private:
    struct Parts;
    Device* device_ = nullptr;
    std::shared_ptr<Parts> parts_;
    std::uint32_t push_bytes_ = 0;
    std::string name_;
};

}  // namespace tessera::vulkan

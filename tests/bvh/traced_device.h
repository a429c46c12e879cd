#pragma once

#include <glm/vec3.hpp>
#include <span>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/transfer.h"
#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

enum class Traversal {
    Plain,    // the baseline, by address
    Address,  // wide nodes by address
    Texels    // wide nodes as texels
};

// A set of rays traced through a scene on a device, as often as wanted.
class TracedDevice final {
  public:
    TracedDevice(Device& device, const TracedScene& scene, std::span<const TestRay> rays, Traversal traversal,
                 std::uint32_t question);

    void run() const { vulkan::run(device_, pass_); }
    std::vector<shading::Hit> hits() const { return download<shading::Hit>(device_, hits_); }

  private:
    Device& device_;
    Buffer pool_, rays_, hits_;
    ComputePipeline pipeline_;
    Pass pass_;
};

}  // namespace tessera::vulkan

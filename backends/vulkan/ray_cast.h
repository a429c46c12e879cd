#pragma once

#include <span>
#include <vector>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/traversal.h"
#include "mediator/shading/ray_query.h"

namespace tessera::vulkan {

struct CastSettings {
    Traversal traversal = Traversal::Texels;
    std::uint32_t question = 0;      // Bvh... of shading/bvh_layout.h
    std::uint32_t passes_every = 0;  // with BvhAlpha: every n-th triangle is transparent; 0: none
};

// Traversal without shading: traces a set of rays through the pool of a scene, repeatedly. The pool outlives
// it.
class RayCast final {
  public:
    RayCast(Device& device, const Buffer& pool, std::uint32_t top, std::span<const shading::RayQuery> rays,
            const CastSettings& settings);

    void run() const { vulkan::run(device_, dispatch_); }  // blocks until done
    std::vector<shading::Hit> hits() const { return download<shading::Hit>(device_, hits_); }

  private:
    Device& device_;
    Buffer rays_, hits_;
    ComputePipeline pipeline_;
    Dispatch dispatch_;
};

}  // namespace tessera::vulkan

#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "backends/vulkan/device/pipeline.h"
#include "mediator/shading/records.h"

namespace tessera::vulkan {

// What a kernel is made for: what it need not do is left out of it.
struct KernelKind {
    std::uint32_t features = 0;  // of the scene: Feature... of records.h
    std::uint32_t channels = 0, keeps = 0, renderer = 0, pixel_filter = 0;  // of the view

    friend auto operator<=>(const KernelKind&, const KernelKind&) = default;
};
KernelKind kind_of(std::uint32_t features, const shading::View& view);

// The kernels that were asked for so far. Thread-safe.
class Kernels final {
  public:
    explicit Kernels(Device& device);

    // Invocations of a workgroup.
    std::uint32_t group_size() const { return group_size_; }
    // Whether the pool of the acceleration structure is bound as texels, which is faster where it fits.
    enum class PoolAccess { Texels, Address };
    const ComputePipeline& find(const KernelKind& kind, PoolAccess access);

  private:
    Device& device_;
    std::uint32_t group_size_;
    std::mutex mutex_;  // protects:
    std::map<std::pair<KernelKind, PoolAccess>, std::unique_ptr<ComputePipeline>> made_;
};

}  // namespace tessera::vulkan

#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/traversal.h"

namespace tessera::vulkan {

// What a kernel is made for: what it need not do is left out of it.
struct KernelKind {
    std::uint32_t features = 0;                // of the scene: Feature... of records.h
    bool specular_trees = false;               // the view wants the Whitted renderer or the range channel
    bool rasterised = false;                   // from first hits that are drawn; with specular trees
    Traversal traversal = Traversal::Address;  // Plain: without specular trees

    friend auto operator<=>(const KernelKind&, const KernelKind&) = default;
};

// The kernels that were asked for so far. Thread-safe.
class Kernels final {
  public:
    explicit Kernels(Device& device);

    // Invocations of a workgroup.
    std::uint32_t group_size() const { return group_size_; }
    const ComputePipeline& find(KernelKind kind);  // traces samples
    const ComputePipeline& merging();              // merges them into blocks

  private:
    Device& device_;
    std::uint32_t group_size_;
    std::mutex mutex_;  // protects:
    std::map<KernelKind, std::unique_ptr<ComputePipeline>> made_;
    std::unique_ptr<ComputePipeline> merging_;
};

}  // namespace tessera::vulkan

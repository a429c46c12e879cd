#pragma once

#include <future>
#include <map>
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

// A kernel that is made, or was: drivers take seconds for a large one, so whoever needs it waits for it as
// long as he likes. get() throws what the making threw.
using Kernel = std::shared_future<ComputePipeline>;

// The kernels that were asked for so far, each made by a thread of its own. Thread-safe. Its end waits for
// what is being made.
class Kernels final {
  public:
    explicit Kernels(Device& device);

    // Invocations of a workgroup.
    std::uint32_t group_size() const { return group_size_; }
    Kernel find(KernelKind kind);  // traces samples
    Kernel merging();              // merges them into blocks

  private:
    Device& device_;
    std::uint32_t group_size_;
    std::mutex mutex_;  // protects:
    std::map<KernelKind, Kernel> made_;
    Kernel merging_;
};

}  // namespace tessera::vulkan

#pragma once

#include <future>
#include <map>
#include <mutex>

#include "backends/vulkan/device/pipeline.h"
#include "backends/vulkan/traversal.h"

namespace tessera::vulkan {

// What a kernel is specialised for; code for other features is compiled out.
struct KernelVariant {
    std::uint32_t features = 0;                // Feature... of records.h
    bool specular_trees = false;               // the view uses the Whitted renderer or the headlight feature
    bool rasterised = false;                   // starts from rasterised first hits; implies specular_trees
    Traversal traversal = Traversal::Address;  // Bvh2: without specular trees

    friend auto operator<=>(const KernelVariant&, const KernelVariant&) = default;
};

// A kernel that is being compiled or is ready. Drivers take seconds for a large one, so callers can wait with a
// timeout. get() throws what the compilation threw.
using Kernel = std::shared_future<ComputePipeline>;

// All kernels requested so far, each compiled on its own thread. Thread-safe. The destructor waits for pending
// compilations.
class Kernels final {
  public:
    explicit Kernels(Device& device);

    // Invocations of a workgroup.
    std::uint32_t group_size() const { return group_size_; }
    Kernel find(KernelVariant kind);  // traces samples
    Kernel merge_kernel();            // merges them into blocks

  private:
    Device& device_;
    std::uint32_t group_size_;
    std::mutex mutex_;  // protects:
    std::map<KernelVariant, Kernel> trace_kernels_;
    Kernel merge_kernel_;
};

}  // namespace tessera::vulkan

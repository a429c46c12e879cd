#pragma once

#include <span>

#include "backends/vulkan/bvh/binary_tree.h"
#include "backends/vulkan/device/buffer.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::vulkan {

// The scene as binary BVHs (shading/bvh2_trace.h): the baseline. Rebuilt at each edit. Moving instances stay where
// they are when the shutter opens.
class Bvh2Pool final {
  public:
    explicit Bvh2Pool(Device& device) : device_(device) {}

    // Returns how many meshes were built. Throws Error{OutOfMemory, Internal} and DeviceLost.
    std::uint32_t update(const backend::MeshCatalog& meshes, std::span<const shading::Instance> instances);

    const Buffer& buffer() const { return buffer_; }
    std::uint32_t top() const { return top_; }  // where the top level is, in items

  private:
    Device& device_;
    BinaryTreeBuilder builder_;
    Buffer buffer_;
    std::uint32_t top_ = 0;
};

}  // namespace tessera::vulkan

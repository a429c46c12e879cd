#pragma once

#include <span>

#include "backends/vulkan/bvh/binary_tree.h"
#include "backends/vulkan/device/buffer.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::vulkan {

// The scene as trees of two children (shading/plain_trace.h): the baseline. Built anew at each edit. What
// moves while the shutter is open stands where it is at the beginning.
class PlainPool final {
  public:
    explicit PlainPool(Device& device) : device_(device) {}

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

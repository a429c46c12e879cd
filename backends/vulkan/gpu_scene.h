#pragma once

#include "backends/vulkan/blob_buffers.h"
#include "backends/vulkan/bvh_pool.h"
#include "backends/vulkan/device_table.h"
#include "backends/vulkan/plain_pool.h"
#include "backends/vulkan/traversal.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::vulkan {

enum class Trees {
    Wide,
    Plain  // the baseline that benches measure
};

// A scene on the device: everything that kernels read of it. Made anew from the host's side at any time.
class GpuScene final {
  public:
    GpuScene(Device& device, TreeCache& cache, Trees trees);

    // Throws Error{OutOfMemory} with the sizes, and DeviceLost; then it is to be dropped.
    BvhPool::Work update(const backend::MeshCatalog& meshes, const backend::MeshCatalog::Result& changes,
                         const backend::SceneTables& tables);

    std::uint64_t record() const { return scene_.address(); }  // of shading::Scene
    std::uint32_t features() const { return features_; }
    const Buffer& pool() const { return plain_ ? plain_->buffer() : bvh_.buffer(); }
    std::uint32_t top() const { return plain_ ? plain_->top() : bvh_.top(); }
    Traversal traversal() const;  // what finds hits in the pool
    std::uint32_t instance_count() const { return instance_count_; }
    // RasterBound of each instance; none with plain trees.
    const Buffer& bounds() const { return bounds_.buffer(); }

  private:
    Device& device_;
    BlobBuffers blobs_;
    BvhPool bvh_;
    std::optional<PlainPool> plain_;
    DeviceTable textures_, materials_, extras_, shaders_, meshes_, mesh_steps_, places_, motions_, bodies_,
        instances_, lights_, emitters_, light_nodes_, sums_, srgb_, energy_, scene_, bounds_;
    std::uint32_t features_ = 0, instance_count_ = 0;
};

}  // namespace tessera::vulkan

#pragma once

#include "backends/vulkan/blob_buffers.h"
#include "backends/vulkan/bvh2_pool.h"
#include "backends/vulkan/bvh_pool.h"
#include "backends/vulkan/device_table.h"
#include "backends/vulkan/traversal.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::vulkan {

enum class Trees {
    Wide,
    Bvh2  // the baseline of benchmarks
};

// A scene on the device: everything that kernels read. Can be rebuilt from the host data at any time.
class GpuScene final {
  public:
    GpuScene(Device& device, TreeCache& cache, Trees trees);

    // Throws Error{OutOfMemory} with the sizes, and DeviceLost; then drop this object.
    BvhPool::Work update(const backend::MeshCatalog& meshes, const backend::MeshCatalog::Result& changes,
                         const backend::SceneTables& tables);

    std::uint64_t record() const { return scene_.address(); }  // of shading::Scene
    std::uint32_t features() const { return features_; }
    const Buffer& pool() const { return bvh2_ ? bvh2_->buffer() : bvh_.buffer(); }
    std::uint32_t top() const { return bvh2_ ? bvh2_->top() : bvh_.top(); }
    Traversal traversal() const;  // how kernels trace the pool
    std::uint32_t instance_count() const { return instance_count_; }
    // RasterBound of each instance; none with binary BVHs.
    const Buffer& bounds() const { return bounds_.buffer(); }

  private:
    Device& device_;
    BlobBuffers blobs_;
    BvhPool bvh_;
    std::optional<Bvh2Pool> bvh2_;
    DeviceTable textures_, materials_, extras_, surface_shaders_, meshes_, mesh_keys_, transform_keys_,
        motions_, media_, instances_, lights_, emitters_, light_nodes_, cdfs_, srgb_, energy_, scene_,
        bounds_;
    std::uint32_t features_ = 0, instance_count_ = 0;
};

}  // namespace tessera::vulkan

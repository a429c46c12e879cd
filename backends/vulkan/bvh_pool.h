#pragma once

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "backends/vulkan/bvh/top_bvh.h"
#include "backends/vulkan/bvh/tree_cache.h"
#include "backends/vulkan/device/buffer.h"
#include "backends/vulkan/device/range_allocator.h"
#include "mediator/backend/tables/tables.h"

namespace tessera::vulkan {

// The acceleration structures of a scene in one pool of 16-byte items on the device
// (mediator/shading/bvh_layout.h), updated by the cheapest operation: refit or rebuild.
class BvhPool final {
  public:
    BvhPool(Device& device, TreeCache& trees) : device_(device), trees_(trees) {}

    struct Work {
        std::uint32_t rebuilt = 0, refitted = 0;  // without trees loaded from the cache
    };
    // Updates the BVHs of meshes to the catalog, then the top level to the instances. A tree whose refit would
    // be too expensive to trace is rebuilt. Throws Error{OutOfMemory} and DeviceLost; then drop the pool.
    Work update(const backend::MeshCatalog& meshes, const backend::MeshCatalog::Result& changes,
                const backend::SceneTables& tables);

    const Buffer& buffer() const { return buffer_; }
    // World bounds of each instance; empty: it is left out and never hit.
    const std::vector<Box>& boxes() const { return boxes_; }
    std::uint32_t top() const { return top_range_.item(); }  // where the top level's root is, in items

  private:
    // A range of items.
    struct PoolRange {
        std::uint64_t offset = 0, bytes = 0;
        bool allocated = false;
        std::uint32_t item() const { return static_cast<std::uint32_t>(offset / 16); }
    };
    struct MeshRanges {
        WideTree tree;
        double built_cost = 0.0;
        PoolRange nodes, triangles;
        std::uint32_t key_intervals = 0;  // of a deforming mesh
        bool dirty = true;                // not uploaded yet
    };

    bool refit(MeshRanges& ranges, const backend::Mesh& mesh);
    void insert(ObjectId id, WideTree&& tree, std::size_t key_intervals);
    void update_top(const backend::SceneTables& tables);
    // Allocates all ranges that are not allocated yet, in a larger pool if needed.
    void allocate_ranges(std::uint64_t top_bytes);
    bool try_allocate();
    bool try_allocate(PoolRange& range);
    void release(PoolRange& range);
    void send(MeshRanges& ranges, const backend::Mesh& mesh);

    Device& device_;
    TreeCache& trees_;
    BinaryTreeBuilder builder_;
    std::map<ObjectId, MeshRanges> meshes_;
    Buffer buffer_;
    std::optional<RangeAllocator> ranges_;
    TopBvh top_;
    double top_built_cost_ = 0.0;
    PoolRange top_range_;
    std::vector<Box> boxes_;
};

}  // namespace tessera::vulkan

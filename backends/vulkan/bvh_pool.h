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
// (mediator/shading/bvh_layout.h), in step with its meshes and instances at the cheapest level.
class BvhPool final {
  public:
    BvhPool(Device& device, TreeCache& trees) : device_(device), trees_(trees) {}

    struct Work {
        std::uint32_t rebuilt = 0, refitted = 0;  // trees that the cache had are neither
    };
    // Brings the meshes in step with the catalog, then the top level with the instances. A refit that would
    // make a tree bad is a rebuild. Throws Error{OutOfMemory} and DeviceLost; the pool is to be dropped then.
    Work update(const backend::MeshCatalog& meshes, const backend::MeshCatalog::Result& changes,
                const backend::SceneTables& tables);

    const Buffer& buffer() const { return buffer_; }
    // What each instance can be hit in; empty: it is left out and never hit.
    const std::vector<Box>& boxes() const { return boxes_; }
    std::uint32_t top() const { return top_row_.item(); }  // where the top level's root is, in items

  private:
    // A row of items.
    struct Row {
        std::uint64_t offset = 0, bytes = 0;
        bool placed = false;
        std::uint32_t item() const { return static_cast<std::uint32_t>(offset / 16); }
    };
    struct MeshRows {
        WideTree tree;
        double built_cost = 0.0;
        Row nodes, triangles;
        std::uint32_t steps = 0;  // of its motion, after the beginning
        bool dirty = true;        // the device does not have it yet
    };

    bool refit(MeshRows& rows, const backend::Mesh& mesh);
    void insert(ObjectId id, WideTree&& tree, std::size_t steps);
    void update_top(const backend::SceneTables& tables);
    // Places all rows that have no place, in a larger pool if need be.
    void place_rows(std::uint64_t top_bytes);
    bool try_place();
    bool try_place(Row& row);
    void release(Row& row);
    void send(MeshRows& rows, const backend::Mesh& mesh);

    Device& device_;
    TreeCache& trees_;
    BinaryTreeBuilder builder_;
    std::map<ObjectId, MeshRows> meshes_;
    Buffer buffer_;
    std::optional<RangeAllocator> ranges_;
    TopBvh top_;
    double top_built_cost_ = 0.0;
    Row top_row_;
    std::vector<Box> boxes_;
};

}  // namespace tessera::vulkan

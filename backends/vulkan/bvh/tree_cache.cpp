#include "backends/vulkan/bvh/tree_cache.h"

#include <utility>

#include "backends/vulkan/bvh/tree_serialization.h"

namespace tessera::vulkan {

namespace {

// Incremented with every change of the file format or of how trees are built from the same settings.
constexpr std::uint32_t Format = 1;

Hash256 key_of(const MeshHashes& hashes, const TraversalCosts& costs) {
    Blake2b hash;
    const auto add = [&](const auto& value) { hash.update(std::as_bytes(std::span(&value, 1))); };
    add(Format);
    add(RTC_VERSION);
    add(shading::BvhWidth);
    add(shading::BvhLeafTriangles);
    add(shading::BvhMeshDepth);
    add(costs.node);
    add(costs.triangle);
    add(costs.leaf_triangles);
    add(hashes.positions.bytes);
    add(hashes.triangles.bytes);
    return hash.finish();
}

}  // namespace

TreeCache::TreeCache(std::filesystem::path folder, std::uint64_t byte_limit)
    : files_(std::move(folder), "tree", byte_limit) {}

std::optional<WideTree> TreeCache::load(const MeshData& mesh, const MeshHashes& hashes,
                                        const TraversalCosts& costs) {
    if (mesh.triangles.size() < MinTriangles) return std::nullopt;
    const auto bytes = files_.load(key_of(hashes, costs));
    if (!bytes) return std::nullopt;
    std::optional<WideTree> tree = deserialize_tree(*bytes, mesh, costs);
    if (!tree) {
        const std::scoped_lock lock(mutex_);
        notes_ = {"the cache folder has a BVH that does not match its mesh; it is rebuilt"};
    }
    return tree;
}

void TreeCache::save(const WideTree& tree, const MeshHashes& hashes, const TraversalCosts& costs) {
    if (tree.primitives.size() < MinTriangles) return;
    files_.save(key_of(hashes, costs), serialize_tree(tree));
}

std::vector<std::string> TreeCache::take_notes() {
    std::vector<std::string> notes = files_.take_notes();
    const std::scoped_lock lock(mutex_);
    notes.insert(notes.end(), notes_.begin(), notes_.end());
    notes_.clear();
    return notes;
}

}  // namespace tessera::vulkan

#include "backends/vulkan/bvh_pool.h"

#include <algorithm>

#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/mesh_data.h"

namespace tessera::vulkan {

namespace {

MeshHashes hashes_of(const backend::Mesh& mesh) {
    const auto hash_of = [](const scene::BlobPtr& blob) { return blob ? blob->hash() : Hash256(); };
    return {hash_of(mesh.positions), hash_of(mesh.triangles)};
}

}  // namespace

BvhPool::Work BvhPool::update(const backend::MeshCatalog& meshes, const backend::MeshCatalog::Result& changes,
                              const backend::SceneTables& tables) {
    Work work;
    const auto remove = [&](ObjectId id) {
        const auto it = meshes_.find(id);
        if (it == meshes_.end()) return;
        release(it->second.nodes);
        release(it->second.triangles);
        meshes_.erase(it);
    };
    if (changes.everything) {
        while (!meshes_.empty()) remove(meshes_.begin()->first);
    }
    for (const ObjectId id : changes.removed) remove(id);
    for (const auto& [id, step] : changes.changes) {
        if (step == backend::MeshUpdate::ShadingData) continue;
        const backend::Mesh& mesh = *meshes.find(id);
        const auto it = meshes_.find(id);
        const bool moves = step == backend::MeshUpdate::Refit && it != meshes_.end();
        if (moves && refit(it->second, mesh)) {
            ++work.refitted;
            continue;
        }
        remove(id);
        const MeshData data = data_of(mesh);
        // Meshes of an animation are not cached (many versions), nor are deforming ones (their boxes span the motion).
        const bool is_cached = !moves && data.later_positions.empty();
        std::optional<WideTree> tree = is_cached ? trees_.load(data, hashes_of(mesh)) : std::nullopt;
        if (!tree) {
            tree = build_mesh(builder_, data);
            if (is_cached) trees_.save(*tree, hashes_of(mesh));
            ++work.rebuilt;
        }
        insert(id, std::move(*tree), data.later_positions.size());
    }
    // Inner nodes have at least two children, so there are fewer of them than instances, except for the root.
    allocate_ranges((2 * tables.instances.size() + 1) * sizeof(shading::BvhNode) +
                    tables.transform_keys.size() * sizeof(glm::vec4) * shading::BvhTransformItems);
    for (auto& [id, ranges] : meshes_) {
        if (ranges.dirty) send(ranges, *meshes.find(id));
    }
    update_top(tables);
    if (top_.row.size() > top_range_.bytes)
        throw Error(ErrorCode::Internal, "the top level is larger than planned");
    upload_bytes(device_, buffer_, top_.row, top_range_.offset);
    return work;
}

bool BvhPool::refit(MeshRanges& ranges, const backend::Mesh& mesh) {
    ranges.dirty = true;
    return refit_mesh(ranges.tree, data_of(mesh), ranges.built_cost);
}

void BvhPool::insert(ObjectId id, WideTree&& tree, std::size_t key_intervals) {
    MeshRanges ranges;
    ranges.tree = std::move(tree);
    ranges.built_cost = ranges.tree.cost;
    ranges.nodes.bytes = std::max<std::uint64_t>(ranges.tree.nodes.size() * sizeof(shading::BvhNode), 16);
    ranges.key_intervals = static_cast<std::uint32_t>(key_intervals);
    ranges.triangles.bytes = std::max<std::uint64_t>(
        ranges.tree.primitives.size() * (key_intervals + 1) * sizeof(shading::BvhTriangle), 16);
    meshes_.emplace(id, std::move(ranges));
}

void BvhPool::update_top(const backend::SceneTables& tables) {
    const std::span<const shading::Instance> instances = tables.instances;
    std::vector<PlacedMesh> placed(instances.size());
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const shading::Instance& instance = instances[i];
        const MeshRanges& ranges = meshes_.at(ObjectId{instance.object});
        placed[i] = {.linear = instance.linear,
                     .translation = instance.translation,
                     .box = ranges.tree.box,
                     .nodes = ranges.nodes.item(),
                     .triangles = ranges.triangles.item(),
                     .alpha_tested = instance.alpha_tested != 0,
                     .layers = instance.layers,
                     .mesh_key_intervals = ranges.key_intervals};
        if (instance.motion < 0) continue;
        const shading::Motion& motion = tables.motions[static_cast<std::size_t>(instance.motion)];
        placed[i].transform_keys =
            std::span(tables.transform_keys).subspan(motion.first_key, motion.key_intervals + 1);
    }
    boxes_.clear();
    for (const PlacedMesh& instance : placed) boxes_.push_back(world_box(instance));
    if (refit_top(top_, placed, top_built_cost_)) return;
    top_ = build_top(builder_, placed);
    top_built_cost_ = top_.tree.cost;
}

void BvhPool::allocate_ranges(std::uint64_t top_bytes) {
    if (top_range_.bytes != top_bytes) {
        release(top_range_);
        top_range_.bytes = top_bytes;
    }
    if (ranges_ && try_allocate()) return;
    std::uint64_t bytes = top_bytes;
    for (auto& [id, ranges] : meshes_) {
        bytes += ranges.nodes.bytes + ranges.triangles.bytes;
        ranges.nodes.allocated = ranges.triangles.allocated = false;
        ranges.dirty = true;
    }
    top_range_.allocated = false;
    bytes += bytes / 2;  // spare room for edits
    bytes = (bytes + 15) / 16 * 16;
    buffer_ = Buffer();  // freed first: the memory may be needed again
    ranges_.reset();
    buffer_ = Buffer(device_, bytes);
    ranges_.emplace(bytes);
    if (!try_allocate()) throw Error(ErrorCode::Internal, "the ranges of meshes do not fit their pool");
}

bool BvhPool::try_allocate() {
    for (auto& [id, ranges] : meshes_) {
        if (!try_allocate(ranges.nodes) || !try_allocate(ranges.triangles)) return false;
    }
    return try_allocate(top_range_);
}

bool BvhPool::try_allocate(PoolRange& range) {
    if (range.allocated) return true;
    const auto offset = ranges_->allocate(range.bytes, 16);
    if (!offset) return false;
    range.offset = *offset;
    range.allocated = true;
    return true;
}

void BvhPool::release(PoolRange& range) {
    if (range.allocated) ranges_->release(range.offset, range.bytes);
    range.allocated = false;
}

void BvhPool::send(MeshRanges& ranges, const backend::Mesh& mesh) {
    upload_bytes(device_, buffer_, std::as_bytes(std::span(ranges.tree.nodes)), ranges.nodes.offset);
    std::vector<shading::BvhTriangle> triangles(ranges.tree.primitives.size() * (ranges.key_intervals + 1));
    write_triangles(ranges.tree.primitives, data_of(mesh), triangles);
    upload_bytes(device_, buffer_, std::as_bytes(std::span(triangles)), ranges.triangles.offset);
    ranges.dirty = false;
}

}  // namespace tessera::vulkan

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
        const auto place = meshes_.find(id);
        if (place == meshes_.end()) return;
        release(place->second.nodes);
        release(place->second.triangles);
        meshes_.erase(place);
    };
    if (changes.everything) {
        while (!meshes_.empty()) remove(meshes_.begin()->first);
    }
    for (const ObjectId id : changes.removed) remove(id);
    for (const auto& [id, step] : changes.changes) {
        if (step == backend::MeshStep::ShadingData) continue;
        const backend::Mesh& mesh = *meshes.find(id);
        const auto place = meshes_.find(id);
        const bool moves = step == backend::MeshStep::Refit && place != meshes_.end();
        if (moves && refit(place->second, mesh)) {
            ++work.refitted;
            continue;
        }
        remove(id);
        const MeshData data = data_of(mesh);
        // One of many positions of an animation is not worth a file; one that bends has boxes of its own.
        const bool is_kept = !moves && data.steps.empty();
        std::optional<WideTree> tree = is_kept ? trees_.load(data, hashes_of(mesh)) : std::nullopt;
        if (!tree) {
            tree = build_mesh(builder_, data);
            if (is_kept) trees_.save(*tree, hashes_of(mesh));
            ++work.rebuilt;
        }
        insert(id, std::move(*tree), data.steps.size());
    }
    // Nodes have two children at least, so there are fewer of them than instances, but for the root.
    place_rows((2 * tables.instances.size() + 1) * sizeof(shading::BvhNode) +
               tables.places.size() * sizeof(glm::vec4) * shading::BvhPlaceItems);
    for (auto& [id, rows] : meshes_) {
        if (rows.dirty) send(rows, *meshes.find(id));
    }
    update_top(tables);
    if (top_.row.size() > top_row_.bytes)
        throw Error(ErrorCode::Internal, "the top level is larger than planned");
    upload_bytes(device_, buffer_, top_.row, top_row_.offset);
    return work;
}

bool BvhPool::refit(MeshRows& rows, const backend::Mesh& mesh) {
    rows.dirty = true;
    return refit_mesh(rows.tree, data_of(mesh), rows.built_cost);
}

void BvhPool::insert(ObjectId id, WideTree&& tree, std::size_t steps) {
    MeshRows rows;
    rows.tree = std::move(tree);
    rows.built_cost = rows.tree.cost;
    rows.nodes.bytes = std::max<std::uint64_t>(rows.tree.nodes.size() * sizeof(shading::BvhNode), 16);
    rows.steps = static_cast<std::uint32_t>(steps);
    rows.triangles.bytes =
        std::max<std::uint64_t>(rows.tree.primitives.size() * (steps + 1) * sizeof(shading::BvhTriangle), 16);
    meshes_.emplace(id, std::move(rows));
}

void BvhPool::update_top(const backend::SceneTables& tables) {
    const std::span<const shading::Instance> instances = tables.instances;
    std::vector<PlacedMesh> placed(instances.size());
    for (std::size_t i = 0; i < instances.size(); ++i) {
        const shading::Instance& instance = instances[i];
        const MeshRows& rows = meshes_.at(ObjectId{instance.object});
        placed[i] = {.linear = instance.linear,
                     .translation = instance.translation,
                     .box = rows.tree.box,
                     .nodes = rows.nodes.item(),
                     .triangles = rows.triangles.item(),
                     .alpha_tested = instance.alpha_tested != 0,
                     .layers = instance.layers,
                     .mesh_steps = rows.steps};
        if (instance.motion < 0) continue;
        const shading::Motion& motion = tables.motions[static_cast<std::size_t>(instance.motion)];
        placed[i].places = std::span(tables.places).subspan(motion.first_place, motion.steps + 1);
    }
    boxes_.clear();
    for (const PlacedMesh& instance : placed) boxes_.push_back(world_box(instance));
    if (refit_top(top_, placed, top_built_cost_)) return;
    top_ = build_top(builder_, placed);
    top_built_cost_ = top_.tree.cost;
}

void BvhPool::place_rows(std::uint64_t top_bytes) {
    if (top_row_.bytes != top_bytes) {
        release(top_row_);
        top_row_.bytes = top_bytes;
    }
    if (ranges_ && try_place()) return;
    std::uint64_t bytes = top_bytes;
    for (auto& [id, rows] : meshes_) {
        bytes += rows.nodes.bytes + rows.triangles.bytes;
        rows.nodes.placed = rows.triangles.placed = false;
        rows.dirty = true;
    }
    top_row_.placed = false;
    bytes += bytes / 2;  // room for edits
    bytes = (bytes + 15) / 16 * 16;
    buffer_ = Buffer();  // first: the memory may be needed again
    ranges_.reset();
    buffer_ = Buffer(device_, bytes);
    ranges_.emplace(bytes);
    if (!try_place()) throw Error(ErrorCode::Internal, "the rows of meshes do not fit their pool");
}

bool BvhPool::try_place() {
    for (auto& [id, rows] : meshes_) {
        if (!try_place(rows.nodes) || !try_place(rows.triangles)) return false;
    }
    return try_place(top_row_);
}

bool BvhPool::try_place(Row& row) {
    if (row.placed) return true;
    const auto offset = ranges_->allocate(row.bytes, 16);
    if (!offset) return false;
    row.offset = *offset;
    row.placed = true;
    return true;
}

void BvhPool::release(Row& row) {
    if (row.placed) ranges_->release(row.offset, row.bytes);
    row.placed = false;
}

void BvhPool::send(MeshRows& rows, const backend::Mesh& mesh) {
    upload_bytes(device_, buffer_, std::as_bytes(std::span(rows.tree.nodes)), rows.nodes.offset);
    std::vector<shading::BvhTriangle> triangles(rows.tree.primitives.size() * (rows.steps + 1));
    write_triangles(rows.tree.primitives, data_of(mesh), triangles);
    upload_bytes(device_, buffer_, std::as_bytes(std::span(triangles)), rows.triangles.offset);
    rows.dirty = false;
}

}  // namespace tessera::vulkan

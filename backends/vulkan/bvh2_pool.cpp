#include "backends/vulkan/bvh2_pool.h"

#include <cstring>
#include <map>

#include "backends/vulkan/bvh/bvh2.h"
#include "backends/vulkan/device/transfer.h"
#include "backends/vulkan/mesh_data.h"

namespace tessera::vulkan {

namespace {

template <class T>
std::uint32_t append(std::vector<glm::uvec4>& pool, const std::vector<T>& row) {
    const auto place = static_cast<std::uint32_t>(pool.size());
    pool.resize(pool.size() + row.size() * sizeof(T) / sizeof(glm::uvec4));
    if (!row.empty()) std::memcpy(&pool[place], row.data(), row.size() * sizeof(T));
    return place;
}

}  // namespace

std::uint32_t Bvh2Pool::update(const backend::MeshCatalog& meshes,
                               std::span<const shading::Instance> instances) {
    std::vector<glm::uvec4> pool;
    std::map<ObjectId, PlacedMesh> rows;
    for (const auto& [id, mesh] : meshes.all()) {
        MeshData data = data_of(mesh);
        data.later_positions.clear();
        const Bvh2 tree = build_bvh2_mesh(builder_, data);
        std::vector<shading::BvhTriangle> triangles(tree.primitives.size());
        write_triangles(tree.primitives, data, triangles);
        PlacedMesh& placed = rows[id];
        for (const Box& box : boxes_of(data).boxes) placed.box.add(box);
        placed.nodes = append(pool, tree.nodes);
        placed.triangles = append(pool, triangles);
    }
    std::vector<PlacedMesh> placed;
    for (const shading::Instance& instance : instances) {
        PlacedMesh mesh = rows.at(ObjectId{instance.object});
        mesh.linear = instance.linear;
        mesh.translation = instance.translation;
        mesh.alpha_tested = instance.alpha_tested != 0;
        mesh.layers = instance.layers;
        placed.push_back(mesh);
    }
    top_ = append(pool, build_bvh2_top(builder_, placed));
    buffer_ = make_buffer(device_, pool);
    return static_cast<std::uint32_t>(rows.size());
}

}  // namespace tessera::vulkan

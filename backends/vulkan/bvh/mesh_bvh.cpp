#include "backends/vulkan/bvh/mesh_bvh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <glm/geometric.hpp>

namespace tessera::vulkan {

namespace {

constexpr float LargestCoordinate = 1.844e18f;  // Embree's FLT_LARGE

bool is_in_range(const glm::vec3& p) {
    return std::fabs(p.x) < LargestCoordinate && std::fabs(p.y) < LargestCoordinate &&
           std::fabs(p.z) < LargestCoordinate;
}

bool has_area(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    // In double: tiny triangles are not degenerate.
    const glm::dvec3 normal = glm::cross(glm::dvec3(b) - glm::dvec3(a), glm::dvec3(c) - glm::dvec3(a));
    return glm::dot(normal, normal) > 0.0;
}

std::span<const glm::vec3> positions_at(const MeshData& mesh, std::size_t step) {
    return step == 0 ? mesh.positions : mesh.later_positions[step - 1];
}

// Empty for an invalid triangle.
Box box_of(const MeshData& mesh, std::uint32_t triangle) {
    const glm::uvec3& corners = mesh.triangles[triangle];
    Box box;
    bool can_be_hit = false;
    for (std::size_t step = 0; step <= mesh.later_positions.size(); ++step) {
        const auto positions = positions_at(mesh, step);
        const glm::vec3 &a = positions[corners.x], &b = positions[corners.y], &c = positions[corners.z];
        if (!is_in_range(a) || !is_in_range(b) || !is_in_range(c)) return {};
        can_be_hit = can_be_hit || has_area(a, b, c);
        box.add(a);
        box.add(b);
        box.add(c);
    }
    return can_be_hit ? box : Box();
}

void fit(WideTree& tree, const MeshData& mesh, const TraversalCosts& costs) {
    fit_boxes(tree, Level::Mesh, costs,
              [&](std::uint32_t place) { return box_of(mesh, tree.primitives[place]); });
}

}  // namespace

MeshBoxes boxes_of(const MeshData& mesh) {
    MeshBoxes all;
    all.boxes.resize(mesh.triangles.size());
    tbb::parallel_for(std::size_t{0}, all.boxes.size(),
                      [&](std::size_t i) { all.boxes[i] = box_of(mesh, static_cast<std::uint32_t>(i)); });
    all.triangles.reserve(all.boxes.size());
    for (std::uint32_t i = 0; i < all.boxes.size(); ++i) {
        if (all.boxes[i].empty()) continue;
        all.boxes[all.triangles.size()] = all.boxes[i];
        all.triangles.push_back(i);
    }
    all.boxes.resize(all.triangles.size());
    return all;
}

WideTree build_mesh(BinaryTreeBuilder& builder, const MeshData& mesh, const TraversalCosts& costs) {
    const MeshBoxes boxes = boxes_of(mesh);
    WideTree tree = collapse(builder.build(boxes.boxes, costs), Level::Mesh, shading::BvhMeshDepth);
    for (std::uint32_t& primitive : tree.primitives) primitive = boxes.triangles[primitive];
    fit(tree, mesh, costs);
    return tree;
}

bool refit_mesh(WideTree& tree, const MeshData& mesh, double built_cost, const TraversalCosts& costs) {
    std::vector<char> kept(mesh.triangles.size());
    for (const std::uint32_t triangle : tree.primitives) kept[triangle] = 1;
    for (std::uint32_t i = 0; i < kept.size(); ++i) {
        if (kept[i] == 0 && !box_of(mesh, i).empty()) return false;
    }
    fit(tree, mesh, costs);
    return tree.cost <= RefitLimit * built_cost;
}

void write_triangles(std::span<const std::uint32_t> primitives, const MeshData& mesh,
                     std::span<shading::BvhTriangle> out) {
    tbb::parallel_for(std::size_t{0}, primitives.size(), [&](std::size_t place) {
        const std::uint32_t triangle = primitives[place];
        const bool can_be_hit =
            !box_of(mesh, triangle).empty();  // after a refit: otherwise zero, which is never hit
        const std::size_t count = mesh.later_positions.size() + 1;
        for (std::size_t step = 0; step < count; ++step) {
            shading::BvhTriangle written{.triangle = triangle};
            if (can_be_hit) {
                const auto positions = positions_at(mesh, step);
                const glm::uvec3& corners = mesh.triangles[triangle];
                written.a = positions[corners.x];
                written.b = positions[corners.y];
                written.c = positions[corners.z];
            }
            out[place * count + step] = written;
        }
    });
}

}  // namespace tessera::vulkan

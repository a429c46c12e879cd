#include "client/import/mesh_data.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mediator/base/error.h"

namespace tessera::import {
namespace {

template <class Vector>
bool all_finite(const std::vector<Vector>& values) {
    return std::all_of(values.begin(), values.end(), [](const Vector& value) {
        for (int i = 0; i < Vector::length(); ++i) {
            if (!std::isfinite(value[i])) return false;
        }
        return true;
    });
}

template <class Vector>
void drop_if_unusable(std::vector<Vector>& values, std::size_t vertices, const char* what,
                      std::vector<std::string>& repairs) {
    if (values.empty()) return;
    if (values.size() != vertices) {
        repairs.push_back(std::string(what) + " are ignored: " + std::to_string(values.size()) + " for " +
                          std::to_string(vertices) + " vertices");
        values.clear();
    } else if (!all_finite(values)) {
        repairs.push_back(std::string(what) + " are ignored: some are not finite");
        values.clear();
    }
}

glm::dvec3 doubled_area(const MeshData& mesh, std::size_t triangle) {
    const glm::dvec3 a(mesh.positions[mesh.indices[3 * triangle]]);
    const glm::dvec3 b(mesh.positions[mesh.indices[3 * triangle + 1]]);
    const glm::dvec3 c(mesh.positions[mesh.indices[3 * triangle + 2]]);
    return glm::cross(b - a, c - a);
}

glm::vec3 normalized_or(const glm::dvec3& vector, const glm::vec3& otherwise) {
    const double length = glm::length(vector);
    return length > 0.0 && std::isfinite(length) ? glm::vec3(vector / length) : otherwise;
}

void repair_normals(MeshData& mesh, std::vector<std::string>& repairs) {
    std::size_t bad = 0;
    for (glm::vec3& normal : mesh.normals) {
        const double length = glm::length(glm::dvec3(normal));
        const bool usable = std::isfinite(length) && length > 1e-12;
        normal = usable ? glm::vec3(glm::dvec3(normal) / length) : glm::vec3(0.0f);
        bad += usable ? 0 : 1;
    }
    if (bad == 0) return;
    std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) sums[mesh.indices[i]] += doubled_area(mesh, i / 3);
    for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
        if (mesh.normals[i] == glm::vec3(0.0f)) mesh.normals[i] = normalized_or(sums[i], {0.0f, 1.0f, 0.0f});
    }
    repairs.push_back(std::to_string(bad) +
                      " normals of length zero or not finite are recomputed from the triangles");
}

}  // namespace

void Bounds::add(const glm::dvec3& point) {
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
}

void Bounds::add(const Bounds& other, const glm::dmat4& transform) {
    if (other.empty()) return;
    for (int corner = 0; corner < 8; ++corner) {
        add(glm::dvec3(transform * glm::dvec4(corner & 1 ? other.upper.x : other.lower.x,
                                              corner & 2 ? other.upper.y : other.lower.y,
                                              corner & 4 ? other.upper.z : other.lower.z, 1.0)));
    }
}

std::vector<std::uint32_t> triangles_of_strip(std::span<const std::uint32_t> vertices) {
    std::vector<std::uint32_t> triangles;
    for (std::size_t i = 0; i + 2 < vertices.size(); ++i) {
        // Every second triangle swaps two vertices to keep the winding (glTF 3.7.2.1).
        const std::size_t odd = i % 2;
        triangles.insert(triangles.end(), {vertices[i], vertices[i + 1 + odd], vertices[i + 2 - odd]});
    }
    return triangles;
}

std::vector<std::uint32_t> triangles_of_fan(std::span<const std::uint32_t> vertices) {
    std::vector<std::uint32_t> triangles;
    for (std::size_t i = 1; i + 1 < vertices.size(); ++i) {
        triangles.insert(triangles.end(), {vertices[i], vertices[i + 1], vertices[0]});
    }
    return triangles;
}

std::vector<std::string> check_and_repair(MeshData& mesh) {
    const std::size_t vertices = mesh.positions.size();
    const std::size_t beyond = mesh.indices.size() % 3;
    mesh.indices.resize(mesh.indices.size() - beyond);
    if (mesh.indices.empty()) throw Error(ErrorCode::InvalidInput, "it has no triangles");
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        if (mesh.indices[i] >= vertices) {
            throw Error(ErrorCode::InvalidInput, "index " + std::to_string(i) + " refers to vertex " +
                                                     std::to_string(mesh.indices[i]) + " of " +
                                                     std::to_string(vertices));
        }
    }
    if (!all_finite(mesh.positions)) throw Error(ErrorCode::InvalidInput, "some positions are not finite");
    std::vector<std::string> repairs;
    if (beyond != 0)
        repairs.push_back("its last " + std::to_string(beyond) +
                          " vertices form no triangle and are ignored");
    if (!mesh.normals.empty() && mesh.normals.size() != vertices) {
        drop_if_unusable(mesh.normals, vertices, "normals", repairs);
    }
    repair_normals(mesh, repairs);
    drop_if_unusable(mesh.tangents, vertices, "tangents", repairs);
    drop_if_unusable(mesh.tex_coords, vertices, "texture coordinates", repairs);
    drop_if_unusable(mesh.tex_coords_1, vertices, "second texture coordinates", repairs);
    drop_if_unusable(mesh.colors, vertices, "vertex colours", repairs);
    return repairs;
}

std::uint64_t count_degenerate(const MeshData& mesh) {
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < mesh.indices.size() / 3; ++i) {
        count += glm::length(doubled_area(mesh, i)) > 0.0 ? 0 : 1;
    }
    return count;
}

Bounds bounds_of(const MeshData& mesh) {
    Bounds bounds;
    for (const std::uint32_t index : mesh.indices) bounds.add(glm::dvec3(mesh.positions[index]));
    return bounds;
}

void make_flat(MeshData& mesh) {
    MeshData flat;
    const auto spread = [&](const auto& from, auto& to) {
        if (from.empty()) return;
        to.reserve(mesh.indices.size());
        for (const std::uint32_t index : mesh.indices) to.push_back(from[index]);
    };
    spread(mesh.positions, flat.positions);
    spread(mesh.tex_coords, flat.tex_coords);
    spread(mesh.tex_coords_1, flat.tex_coords_1);
    spread(mesh.colors, flat.colors);
    spread(mesh.origins, flat.origins);
    flat.normals.resize(mesh.indices.size());
    flat.indices.resize(mesh.indices.size());
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        flat.indices[i] = static_cast<std::uint32_t>(i);
        flat.normals[i] = normalized_or(doubled_area(mesh, i / 3), {0.0f, 1.0f, 0.0f});
    }
    mesh = std::move(flat);
}

}  // namespace tessera::import

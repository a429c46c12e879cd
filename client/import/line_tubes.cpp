#include "client/import/line_tubes.h"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "client/import/limits.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

float tube_radius(const MeshData& mesh) {
    const Bounds bounds = bounds_of(mesh);
    const double diagonal = bounds.empty() ? 0.0 : glm::length(bounds.upper - bounds.lower);
    return diagonal > 0.0 ? static_cast<float>(0.002 * diagonal) : 0.01f;
}

void check(const MeshData& mesh) {
    if (mesh.indices.size() > 2 * MaxPointsOrLines)
        throw Error(ErrorCode::InvalidInput, "it has more than 2^22 points or lines");
    for (const std::uint32_t index : mesh.indices) {
        if (index < mesh.positions.size()) continue;
        throw Error(ErrorCode::InvalidInput, "an index refers to vertex " + std::to_string(index) + " of " +
                                                 std::to_string(mesh.positions.size()));
    }
}

// Adds vertices at offsets from those of another mesh.
class Extruder {
  public:
    explicit Extruder(const MeshData& source) : source_(source) {}

    std::uint32_t add(std::uint32_t vertex, const glm::vec3& offset) {
        mesh.positions.push_back(source_.positions[vertex] + offset);
        copy(source_.colors, mesh.colors, vertex);
        copy(source_.tex_coords, mesh.tex_coords, vertex);
        copy(source_.tex_coords_1, mesh.tex_coords_1, vertex);
        copy(source_.origins, mesh.origins, vertex);
        return static_cast<std::uint32_t>(mesh.positions.size() - 1);
    }

    MeshData mesh;

  private:
    template <class T>
    static void copy(const std::vector<T>& from, std::vector<T>& to, std::uint32_t vertex) {
        if (vertex < from.size()) to.push_back(from[vertex]);
    }

    const MeshData& source_;
};

void add_tube(Extruder& extruder, std::uint32_t from, std::uint32_t to, const glm::vec3& along,
              float radius) {
    const glm::vec3 other = std::abs(along.x) < 0.7f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
    const glm::vec3 u = glm::normalize(glm::cross(along, other)), v = glm::cross(along, u);
    std::array<std::uint32_t, 3> a, b;
    for (std::size_t i = 0; i < 3; ++i) {
        const float angle = 2.0943951f * static_cast<float>(i);
        const glm::vec3 offset = radius * (std::cos(angle) * u + std::sin(angle) * v);
        a[i] = extruder.add(from, offset);
        b[i] = extruder.add(to, offset);
    }
    auto& indices = extruder.mesh.indices;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3;
        indices.insert(indices.end(), {a[i], a[next], b[i], b[i], a[next], b[next]});
    }
    indices.insert(indices.end(), {a[0], a[2], a[1], b[0], b[1], b[2]});
}

}  // namespace

std::vector<std::uint32_t> segments_of_pairs(std::span<const std::uint32_t> vertices) {
    return {vertices.begin(), vertices.begin() + static_cast<std::ptrdiff_t>(vertices.size() / 2 * 2)};
}

std::vector<std::uint32_t> segments_of_strip(std::span<const std::uint32_t> vertices) {
    std::vector<std::uint32_t> segments;
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i)
        segments.insert(segments.end(), {vertices[i], vertices[i + 1]});
    return segments;
}

std::vector<std::uint32_t> segments_of_loop(std::span<const std::uint32_t> vertices) {
    std::vector<std::uint32_t> segments = segments_of_strip(vertices);
    if (vertices.size() > 2) segments.insert(segments.end(), {vertices.back(), vertices.front()});
    return segments;
}

MeshData point_octahedra(const MeshData& points) {
    check(points);
    const float radius = tube_radius(points);
    Extruder extruder(points);
    for (const std::uint32_t point : points.indices) {
        std::array<std::uint32_t, 6> tips;  // -x, +x, -y, +y, -z, +z
        for (std::size_t i = 0; i < 6; ++i) {
            glm::vec3 offset(0.0f);
            offset[static_cast<glm::length_t>(i / 2)] = i % 2 == 0 ? -radius : radius;
            tips[i] = extruder.add(point, offset);
        }
        for (std::size_t octant = 0; octant < 8; ++octant) {
            const std::size_t x = octant & 1, y = octant >> 1 & 1, z = octant >> 2;
            const bool turned = (x + y + z) % 2 == 0;  // each mirrored axis flips the winding
            extruder.mesh.indices.insert(extruder.mesh.indices.end(), {tips[x], tips[turned ? 4 + z : 2 + y],
                                                                       tips[turned ? 2 + y : 4 + z]});
        }
    }
    return std::move(extruder.mesh);
}

MeshData line_tubes(const MeshData& segments) {
    check(segments);
    const float radius = tube_radius(segments);
    Extruder extruder(segments);
    for (std::size_t i = 0; i + 1 < segments.indices.size(); i += 2) {
        const std::uint32_t from = segments.indices[i], to = segments.indices[i + 1];
        const glm::vec3 along = segments.positions[to] - segments.positions[from];
        const float length = glm::length(along);
        if (length > 0.0f) add_tube(extruder, from, to, along / length, radius);
    }
    return std::move(extruder.mesh);
}

}  // namespace tessera::import

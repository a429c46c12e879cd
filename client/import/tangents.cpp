#include "client/import/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace tessera::import {
namespace {

constexpr std::uint32_t None = 0xffffffffu;

// Equal vertices of the mesh get the same number.
class Welder {
  public:
    Welder(const MeshData& mesh, const std::vector<glm::vec2>& coords) : mesh_(mesh), coords_(coords) {}

    std::vector<std::uint32_t> numbers() {
        std::vector<std::uint32_t> order(mesh_.positions.size());
        for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
        std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
            return std::tuple_cat(key(a), std::tuple(a)) < std::tuple_cat(key(b), std::tuple(b));
        });
        std::vector<std::uint32_t> result(order.size());
        for (std::size_t i = 0; i < order.size(); ++i) {
            const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
            result[order[i]] = same ? result[order[i - 1]] : order[i];
        }
        return result;
    }

  private:
    std::tuple<float, float, float, float, float, float, float, float> key(std::uint32_t i) const {
        const glm::vec3 &p = mesh_.positions[i], &n = mesh_.normals[i];
        return {p.x, p.y, p.z, n.x, n.y, n.z, coords_[i].x, coords_[i].y};
    }

    const MeshData& mesh_;
    const std::vector<glm::vec2>& coords_;
};

glm::dvec3 unit_or_zero(const glm::dvec3& v) {
    const double length = glm::length(v);
    return length > 0.0 && std::isfinite(length) ? v / length : glm::dvec3(0.0);
}

glm::dvec3 on_plane(const glm::dvec3& v, const glm::dvec3& normal) {
    return unit_or_zero(v - normal * glm::dot(normal, v));
}

// What MikkTSpace knows of a triangle.
struct TangentTriangle {
    std::array<std::uint32_t, 3> corners{};                     // numbers of the vertices, welded
    std::array<std::uint32_t, 3> neighbours{None, None, None};  // across the edge from corner k to k + 1
    std::array<std::uint32_t, 3> groups{None, None, None};
    glm::dvec3 along_u{0.0};  // unit length
    bool is_degenerate = false;
    bool is_mapped = false;  // its texture coordinates have an area
    bool keeps_orientation = true;
};

// Corners that share a tangent.
struct TangentGroup {
    std::uint32_t vertex = 0;
    bool keeps_orientation = true;
    glm::dvec3 sum{0.0};
};

class TangentSpace {
  public:
    TangentSpace(const MeshData& mesh, const std::vector<glm::vec2>& coords) : mesh_(mesh), coords_(coords) {
        const std::vector<std::uint32_t> numbers = Welder(mesh, coords).numbers();
        triangles_.resize(mesh.indices.size() / 3);
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            for (std::size_t k = 0; k < 3; ++k) triangles_[i].corners[k] = numbers[mesh.indices[3 * i + k]];
            measure(triangles_[i]);
        }
        connect();
        group();
        for (TangentTriangle& triangle : triangles_) add_to_groups(triangle);
        give_to_degenerate();
    }

    // Of a corner: its group, None for an arbitrary tangent.
    std::uint32_t group_of(std::size_t triangle, std::size_t corner) const {
        return triangles_[triangle].groups[corner];
    }

    glm::vec4 tangent(std::uint32_t group, const glm::vec3& normal) const {
        const glm::dvec3 n = unit_or_zero(glm::dvec3(normal));
        const glm::dvec3 other = std::abs(n.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        glm::dvec3 u = group == None ? glm::dvec3(0.0) : unit_or_zero(groups_[group].sum);
        if (u == glm::dvec3(0.0)) u = on_plane(other, n);
        if (u == glm::dvec3(0.0)) u = glm::dvec3(1.0, 0.0, 0.0);
        const bool mirrored = group != None && !groups_[group].keeps_orientation;
        return {glm::vec3(u), mirrored ? -1.0f : 1.0f};
    }

  private:
    glm::dvec3 position(std::uint32_t vertex) const { return glm::dvec3(mesh_.positions[vertex]); }
    glm::dvec3 normal(std::uint32_t vertex) const { return unit_or_zero(glm::dvec3(mesh_.normals[vertex])); }

    void measure(TangentTriangle& triangle) const {
        const auto [a, b, c] = triangle.corners;
        const glm::dvec3 p0 = position(a), p1 = position(b), p2 = position(c);
        triangle.is_degenerate = p0 == p1 || p1 == p2 || p2 == p0;
        const glm::dvec2 t0(coords_[a]), d1 = glm::dvec2(coords_[b]) - t0, d2 = glm::dvec2(coords_[c]) - t0;
        const double area = d1.x * d2.y - d2.x * d1.y;
        if (!(area != 0.0) || !std::isfinite(area)) return;
        // In glTF's texture space v points down, so that a front-facing, unmirrored triangle has a negative
        // area there; its bitangent, along -v, is w * cross(normal, tangent) with w = +1.
        triangle.keeps_orientation = area < 0.0;
        const double sign = area < 0.0 ? -1.0 : 1.0;
        triangle.along_u = unit_or_zero(((p1 - p0) * d2.y - (p2 - p0) * d1.y) * sign);
        triangle.is_mapped = triangle.along_u != glm::dvec3(0.0);
    }

    // Triangles are neighbours across an edge that both have, in opposite directions; of several the first ones.
    void connect() {
        struct Edge {
            std::uint32_t low, high, triangle;
            std::uint8_t corner;
            bool rises;
        };
        std::vector<Edge> edges;
        edges.reserve(triangles_.size() * 3);
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            if (triangles_[i].is_degenerate) continue;
            for (std::uint8_t k = 0; k < 3; ++k) {
                const std::uint32_t from = triangles_[i].corners[k],
                                    to = triangles_[i].corners[(k + 1u) % 3u];
                edges.push_back({std::min(from, to), std::max(from, to), i, k, from < to});
            }
        }
        std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
            return std::tie(a.low, a.high, a.triangle, a.corner) <
                   std::tie(b.low, b.high, b.triangle, b.corner);
        });
        for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
            while (last < edges.size() && edges[last].low == edges[first].low &&
                   edges[last].high == edges[first].high)
                ++last;
            // Those of both directions in pairs, in order.
            std::size_t up = first, down = first;
            while (true) {
                while (up < last && !edges[up].rises) ++up;
                while (down < last && edges[down].rises) ++down;
                if (up == last || down == last) break;
                triangles_[edges[up].triangle].neighbours[edges[up].corner] = edges[down].triangle;
                triangles_[edges[down].triangle].neighbours[edges[down].corner] = edges[up].triangle;
                ++up;
                ++down;
            }
        }
    }

    void group() {
        for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
            if (!triangles_[i].is_mapped || triangles_[i].is_degenerate) continue;
            for (std::size_t k = 0; k < 3; ++k) {
                if (triangles_[i].groups[k] != None) continue;
                groups_.push_back({triangles_[i].corners[k], triangles_[i].keeps_orientation});
                grow(i);
            }
        }
    }

    // Gives the last group all triangles around its vertex that are connected to the first one.
    void grow(std::uint32_t first) {
        const auto id = static_cast<std::uint32_t>(groups_.size() - 1);
        const TangentGroup& group = groups_.back();
        std::vector<std::uint32_t> open{first};
        while (!open.empty()) {
            const std::uint32_t at = open.back();
            open.pop_back();
            if (at == None) continue;
            TangentTriangle& triangle = triangles_[at];
            const auto corner = static_cast<std::size_t>(
                std::find(triangle.corners.begin(), triangle.corners.end(), group.vertex) -
                triangle.corners.begin());
            if (triangle.groups[corner] != None) continue;
            const bool is_new = triangle.groups == std::array<std::uint32_t, 3>{None, None, None};
            if (!triangle.is_mapped && is_new) triangle.keeps_orientation = group.keeps_orientation;
            if (triangle.keeps_orientation != group.keeps_orientation) continue;
            triangle.groups[corner] = id;
            open.push_back(triangle.neighbours[(corner + 2) % 3]);
            open.push_back(triangle.neighbours[corner]);
        }
    }

    void add_to_groups(const TangentTriangle& triangle) {
        if (!triangle.is_mapped) return;
        for (std::size_t k = 0; k < 3; ++k) {
            if (triangle.groups[k] == None) continue;
            const std::uint32_t vertex = triangle.corners[k];
            const glm::dvec3 n = normal(vertex), p = position(vertex);
            const glm::dvec3 before = on_plane(position(triangle.corners[(k + 2) % 3]) - p, n);
            const glm::dvec3 after = on_plane(position(triangle.corners[(k + 1) % 3]) - p, n);
            const double angle = std::acos(std::clamp(glm::dot(before, after), -1.0, 1.0));
            groups_[triangle.groups[k]].sum += on_plane(triangle.along_u, n) * angle;
        }
    }

    // They have no angle of their own: any other triangle's tangent of the same vertex.
    void give_to_degenerate() {
        std::unordered_map<std::uint32_t, std::uint32_t> group_of_vertex;
        for (const TangentTriangle& triangle : triangles_) {
            if (!triangle.is_degenerate) continue;
            for (const std::uint32_t vertex : triangle.corners) group_of_vertex.emplace(vertex, None);
        }
        if (group_of_vertex.empty()) return;
        for (std::uint32_t id = 0; id < groups_.size(); ++id) {
            const auto found = group_of_vertex.find(groups_[id].vertex);
            if (found != group_of_vertex.end() && found->second == None) found->second = id;
        }
        for (TangentTriangle& triangle : triangles_) {
            if (!triangle.is_degenerate) continue;
            for (std::size_t k = 0; k < 3; ++k) triangle.groups[k] = group_of_vertex[triangle.corners[k]];
        }
    }

    const MeshData& mesh_;
    const std::vector<glm::vec2>& coords_;
    std::vector<TangentTriangle> triangles_;
    std::vector<TangentGroup> groups_;
};

std::uint32_t copy_of(MeshData& mesh, std::uint32_t vertex) {
    const auto result = static_cast<std::uint32_t>(mesh.positions.size());
    const auto repeat = [&](auto& values) {
        if (values.empty()) return;
        const auto value = values[vertex];
        values.push_back(value);
    };
    repeat(mesh.positions);
    repeat(mesh.normals);
    repeat(mesh.tex_coords);
    repeat(mesh.tex_coords_1);
    repeat(mesh.colors);
    repeat(mesh.origins);
    return result;
}

}  // namespace

void generate_tangents(MeshData& mesh, std::uint32_t set) {
    const TangentSpace space(mesh, set == 0 ? mesh.tex_coords : mesh.tex_coords_1);
    // The groups of each vertex, as a list from its first one.
    struct Copy {
        std::uint32_t group, vertex, next;
    };
    constexpr std::uint32_t Unused = None - 1;
    std::vector<Copy> copies(mesh.positions.size());
    for (std::uint32_t i = 0; i < copies.size(); ++i) copies[i] = {Unused, i, None};
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
        const std::uint32_t group = space.group_of(i / 3, i % 3);
        std::uint32_t at = mesh.indices[i];
        while (copies[at].group != group && copies[at].group != Unused && copies[at].next != None)
            at = copies[at].next;
        if (copies[at].group == Unused) copies[at].group = group;
        if (copies[at].group != group) {
            const std::uint32_t vertex = copy_of(mesh, mesh.indices[i]);
            copies[at].next = vertex;
            copies.push_back({group, vertex, None});
            at = vertex;
        }
        mesh.indices[i] = copies[at].vertex;
    }
    mesh.tangents.resize(mesh.positions.size());
    for (std::uint32_t i = 0; i < copies.size(); ++i) {
        const std::uint32_t group = copies[i].group == Unused ? None : copies[i].group;
        mesh.tangents[i] = space.tangent(group, mesh.normals[i]);
    }
}

}  // namespace tessera::import

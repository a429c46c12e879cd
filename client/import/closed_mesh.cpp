#include "client/import/closed_mesh.h"

#include <algorithm>
#include <cstring>
#include <glm/geometric.hpp>
#include <map>
#include <numeric>
#include <tuple>
#include <unordered_map>
#include <vector>

namespace tessera::import {
namespace {

class CornerWelder {
  public:
    std::uint32_t number(glm::vec3 position) {
        position += 0.0f;  // no negative zero
        const auto [entry, is_new] =
            numbers_.try_emplace(position, static_cast<std::uint32_t>(positions_.size()));
        if (is_new) positions_.push_back(position);
        return entry->second;
    }
    glm::dvec3 position(std::uint32_t number) const { return glm::dvec3(positions_[number]); }
    std::size_t size() const { return positions_.size(); }

  private:
    struct HashOfBits {
        std::size_t operator()(const glm::vec3& p) const {
            std::uint32_t bits[3];
            std::memcpy(bits, &p, sizeof bits);
            std::uint64_t mixed = 0;
            for (const std::uint32_t value : bits) mixed = (mixed ^ value) * 0x9e3779b97f4a7c15ull;
            return mixed ^ (mixed >> 32);
        }
    };
    std::unordered_map<glm::vec3, std::uint32_t, HashOfBits> numbers_;
    std::vector<glm::vec3> positions_;
};

struct DirectedEdge {
    std::uint32_t from, to;
    bool is_own;  // of the part that is asked for
    auto key() const { return std::minmax(from, to); }
};

// Vector areas of the connected outlines, each as seen from one of its own corners.
double enclosed_area(const CornerWelder& corners, const std::vector<DirectedEdge>& outline) {
    std::vector<std::uint32_t> parent(corners.size());
    std::iota(parent.begin(), parent.end(), 0u);
    const auto root = [&](std::uint32_t at) {
        while (parent[at] != at) at = parent[at] = parent[parent[at]];
        return at;
    };
    for (const DirectedEdge& edge : outline) parent[root(edge.from)] = root(edge.to);
    std::map<std::uint32_t, glm::dvec3> areas;
    for (const DirectedEdge& edge : outline) {
        const std::uint32_t id = root(edge.from);
        const glm::dvec3 origin = corners.position(id);
        areas[id] +=
            0.5 * glm::cross(corners.position(edge.from) - origin, corners.position(edge.to) - origin);
    }
    double sum = 0.0;
    for (const auto& [id, area] : areas) sum += glm::length(area);
    return sum;
}

}  // namespace

double open_fraction(std::span<const MeshPart> parts, std::size_t part) {
    CornerWelder corners;
    std::vector<DirectedEdge> edges;
    double area = 0.0;
    for (std::size_t p = 0; p < parts.size(); ++p) {
        const std::span<const std::uint32_t> indices = parts[p].indices;
        for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
            std::uint32_t corner[3];
            for (std::size_t k = 0; k < 3; ++k)
                corner[k] = corners.number(parts[p].positions[indices[i + k]]);
            if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
            for (std::size_t k = 0; k < 3; ++k) edges.push_back({corner[k], corner[(k + 1) % 3], p == part});
            const glm::dvec3 origin = corners.position(corner[0]);
            if (p == part)
                area += 0.5 * glm::length(glm::cross(corners.position(corner[1]) - origin,
                                                     corners.position(corner[2]) - origin));
        }
    }
    std::sort(edges.begin(), edges.end(),
              [](const DirectedEdge& a, const DirectedEdge& b) { return a.key() < b.key(); });
    std::vector<DirectedEdge> outline;
    for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
        while (last < edges.size() && edges[last].key() == edges[first].key()) ++last;
        if ((last - first) % 2 == 0) continue;
        const auto own =
            std::find_if(edges.begin() + std::ptrdiff_t(first), edges.begin() + std::ptrdiff_t(last),
                         [](const DirectedEdge& edge) { return edge.is_own; });
        if (own != edges.begin() + std::ptrdiff_t(last)) outline.push_back(*own);
    }
    return area > 0.0 ? std::min(enclosed_area(corners, outline) / area, 1.0) : 0.0;
}

}  // namespace tessera::import

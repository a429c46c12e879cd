#include "client/import/polygon.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace tessera::import {
namespace {

constexpr std::size_t MostCorners = 10'000;  // ear clipping is quadratic

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

// Projects along the dominant axis of the normal; the winding is kept.
std::vector<glm::dvec2> flattened(std::span<const glm::vec3> corners) {
    const glm::dvec3 area = polygon_area(corners);
    int axis = 0;
    for (int i = 1; i < 3; ++i) {
        if (std::abs(area[i]) > std::abs(area[axis])) axis = i;
    }
    const int first = area[axis] < 0.0 ? 2 : 1;
    std::vector<glm::dvec2> flat;
    for (const glm::vec3& corner : corners) {
        flat.emplace_back(static_cast<double>(corner[(axis + first) % 3]),
                          static_cast<double>(corner[(axis + 3 - first) % 3]));
    }
    return flat;
}

class EarClipper {
  public:
    explicit EarClipper(std::vector<glm::dvec2> corners)
        : corners_(std::move(corners)), left_(corners_.size()) {
        for (std::uint32_t i = 0; i < left_.size(); ++i) left_[i] = i;
    }

    std::vector<std::array<std::uint32_t, 3>> clip() {
        std::vector<std::array<std::uint32_t, 3>> triangles;
        std::size_t at = 0, tried = 0;
        while (left_.size() > 2) {
            // A whole round without an ear: the outline crosses itself, and any corner is clipped.
            if (!is_ear(at) && tried++ < left_.size()) {
                at = (at + 1) % left_.size();
                continue;
            }
            triangles.push_back({before(at), left_[at], after(at)});
            left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
            at = at == 0 ? left_.size() - 1 : at - 1;
            tried = 0;
        }
        return triangles;
    }

  private:
    std::uint32_t before(std::size_t at) const { return left_[(at + left_.size() - 1) % left_.size()]; }
    std::uint32_t after(std::size_t at) const { return left_[(at + 1) % left_.size()]; }

    bool is_ear(std::size_t at) const {
        const glm::dvec2 a = corners_[before(at)], b = corners_[left_[at]], c = corners_[after(at)];
        if (!(cross(b - a, c - b) > 0.0)) return false;
        for (const std::uint32_t other : left_) {
            const glm::dvec2 p = corners_[other];
            if (p == a || p == b || p == c) continue;
            if (cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0)
                return false;
        }
        return true;
    }

    std::vector<glm::dvec2> corners_;
    std::vector<std::uint32_t> left_;
};

}  // namespace

glm::dvec3 polygon_area(std::span<const glm::vec3> corners) {
    glm::dvec3 area(0.0);
    if (corners.empty()) return area;
    const glm::dvec3 origin(corners[0]);
    for (std::size_t i = 1; i + 1 < corners.size(); ++i)
        area += glm::cross(glm::dvec3(corners[i]) - origin, glm::dvec3(corners[i + 1]) - origin);
    return area;
}

std::vector<std::array<std::uint32_t, 3>> triangles_of_polygon(std::span<const glm::vec3> corners,
                                                               PolygonShape shape) {
    if (shape == PolygonShape::Any && corners.size() > 3 && corners.size() <= MostCorners)
        return EarClipper(flattened(corners)).clip();
    std::vector<std::array<std::uint32_t, 3>> fan;
    for (std::uint32_t i = 1; i + 1 < corners.size(); ++i) fan.push_back({0, i, i + 1});
    return fan;
}

}  // namespace tessera::import

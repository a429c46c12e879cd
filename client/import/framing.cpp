#include "client/import/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace tessera::import {
namespace {

// The corners of the box along one picture axis: positions, and depths towards the camera.
struct Extent {
    std::array<double, 8> positions, depths;

    // The least distance at which |position - eye| <= slope * (distance - depth) for all corners.
    double min_distance(double slope) const {
        double upper = -std::numeric_limits<double>::infinity(), lower = -upper;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            upper = std::max(upper, positions[i] + slope * depths[i]);
            lower = std::min(lower, positions[i] - slope * depths[i]);
        }
        return (upper - lower) / (2.0 * slope);
    }
    // The eye position that centres the projected corners; by bisection.
    double center_of(double distance) const {
        double lower = *std::min_element(positions.begin(), positions.end());
        double upper = *std::max_element(positions.begin(), positions.end());
        for (int i = 0; i < 100; ++i) {
            const double eye = 0.5 * (lower + upper);
            double least = std::numeric_limits<double>::infinity(), most = -least;
            for (std::size_t k = 0; k < positions.size(); ++k) {
                const double projected = (positions[k] - eye) / (distance - depths[k]);
                least = std::min(least, projected);
                most = std::max(most, projected);
            }
            (least + most > 0.0 ? lower : upper) = eye;
        }
        return 0.5 * (lower + upper);
    }
};

}  // namespace

glm::dmat4 framing_pose(Bounds bounds, double vertical_fov, double aspect_ratio) {
    if (bounds.empty()) bounds = {glm::dvec3(0.0), glm::dvec3(0.0)};
    const glm::dvec3 center = 0.5 * (bounds.lower + bounds.upper);
    if (!(glm::length(bounds.upper - bounds.lower) > 0.0))
        bounds = {center - glm::dvec3(0.5), center + glm::dvec3(0.5)};
    const glm::dvec3 size = bounds.upper - bounds.lower;
    // A box that is long in depth is viewed from its side.
    const bool is_deep = size.z > 2.0 * size.x;
    const glm::dvec3 z = glm::normalize(is_deep ? glm::dvec3(1.0, 0.45, 0.6) : glm::dvec3(0.6, 0.45, 1.0));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), z));
    const glm::dvec3 y = glm::cross(z, x);
    const double slope = (1.0 - 2.0 * FramingMargin) * std::tan(0.5 * vertical_fov);
    Extent across{}, up{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point((corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                               (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                               (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z);
        const glm::dvec3 off = point - center;  // relative, to keep precision far from the origin
        across.positions[corner] = glm::dot(off, x);
        up.positions[corner] = glm::dot(off, y);
        across.depths[corner] = up.depths[corner] = glm::dot(off, z);
    }
    // Very wide pictures would allow a camera inside the box.
    const double front = *std::max_element(up.depths.begin(), up.depths.end());
    const double distance = std::max({across.min_distance(slope * aspect_ratio), up.min_distance(slope),
                                      front + 0.05 * glm::length(size)});
    const glm::dvec3 eye =
        center + across.center_of(distance) * x + up.center_of(distance) * y + distance * z;
    return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), glm::dvec4(eye, 1.0)};
}

}  // namespace tessera::import

#include "client/import/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace tessera::import {
namespace {

// Corners as one axis of the picture sees them: places along it, and depths towards the camera.
struct Span {
    std::array<double, 8> places, depths;

    // The distance at which all are seen where |place - eye| may be slope x (distance - depth).
    double nearest(double slope) const {
        double upper = -std::numeric_limits<double>::infinity(), lower = -upper;
        for (std::size_t i = 0; i < places.size(); ++i) {
            upper = std::max(upper, places[i] + slope * depths[i]);
            lower = std::min(lower, places[i] - slope * depths[i]);
        }
        return (upper - lower) / (2.0 * slope);
    }
    // Where the eye has to be for the projections to reach as far to one side as to the other; by bisection.
    double middle(double distance) const {
        double lower = *std::min_element(places.begin(), places.end());
        double upper = *std::max_element(places.begin(), places.end());
        for (int i = 0; i < 100; ++i) {
            const double eye = 0.5 * (lower + upper);
            double least = std::numeric_limits<double>::infinity(), most = -least;
            for (std::size_t k = 0; k < places.size(); ++k) {
                const double seen = (places[k] - eye) / (distance - depths[k]);
                least = std::min(least, seen);
                most = std::max(most, seen);
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
    // What is long in depth would be seen from its end.
    const bool is_deep = size.z > 2.0 * size.x;
    const glm::dvec3 z = glm::normalize(is_deep ? glm::dvec3(1.0, 0.45, 0.6) : glm::dvec3(0.6, 0.45, 1.0));
    const glm::dvec3 x = glm::normalize(glm::cross(glm::dvec3(0.0, 1.0, 0.0), z));
    const glm::dvec3 y = glm::cross(z, x);
    const double slope = (1.0 - 2.0 * FramingMargin) * std::tan(0.5 * vertical_fov);
    Span across{}, up{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place((corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                               (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                               (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z);
        const glm::dvec3 off = place - center;  // relative, so that far scenes lose no digits
        across.places[corner] = glm::dot(off, x);
        up.places[corner] = glm::dot(off, y);
        across.depths[corner] = up.depths[corner] = glm::dot(off, z);
    }
    // Never in or at the box, which very wide pictures have room for.
    const double front = *std::max_element(up.depths.begin(), up.depths.end());
    const double distance =
        std::max({across.nearest(slope * aspect_ratio), up.nearest(slope), front + 0.05 * glm::length(size)});
    const glm::dvec3 eye = center + across.middle(distance) * x + up.middle(distance) * y + distance * z;
    return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), glm::dvec4(eye, 1.0)};
}

}  // namespace tessera::import

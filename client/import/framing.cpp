#include "client/import/framing.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

namespace tessera::import {
namespace {

// Across one axis of the picture, all in the camera's axes: a corner is seen where |place - eye| is at most
// slope x (distance - depth).
struct Span {
    double slope;
    double upper = -std::numeric_limits<double>::infinity();
    double lower = std::numeric_limits<double>::infinity();

    void add(double place, double depth) {
        upper = std::max(upper, place + slope * depth);
        lower = std::min(lower, place - slope * depth);
    }
    double nearest() const { return (upper - lower) / (2.0 * slope); }  // distance at which all are seen
    double middle() const { return 0.5 * (upper + lower); }
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
    Span across{.slope = slope * aspect_ratio}, up{.slope = slope};
    double front = 0.0;  // depth of the nearest corner
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 place((corner & 1) != 0 ? bounds.upper.x : bounds.lower.x,
                               (corner & 2) != 0 ? bounds.upper.y : bounds.lower.y,
                               (corner & 4) != 0 ? bounds.upper.z : bounds.lower.z);
        const glm::dvec3 off = place - center;  // relative, so that far scenes lose no digits
        front = std::max(front, glm::dot(off, z));
        across.add(glm::dot(off, x), glm::dot(off, z));
        up.add(glm::dot(off, y), glm::dot(off, z));
    }
    // Never in or at the box, which very wide pictures have room for.
    const double distance =
        std::max({across.nearest(), up.nearest(), front + 0.05 * glm::length(bounds.upper - bounds.lower)});
    const glm::dvec3 eye = center + across.middle() * x + up.middle() * y + distance * z;
    return {glm::dvec4(x, 0.0), glm::dvec4(y, 0.0), glm::dvec4(z, 0.0), glm::dvec4(eye, 1.0)};
}

}  // namespace tessera::import

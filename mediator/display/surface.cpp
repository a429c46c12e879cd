#include "mediator/display/surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>

#include "mediator/base/error.h"

namespace tessera::display {

namespace {

using glm::dvec3;

double degrees_between(const dvec3& a, const dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) * 180.0 / std::numbers::pi;
}

bool is_right_angle(const dvec3& a, const dvec3& b) {
    return std::abs(degrees_between(a, b) - 90.0) <= 0.5;
}

dvec3 tilted(const dvec3& v, double tilt) {
    const double c = std::cos(tilt), s = std::sin(tilt);
    return {v.x, c * v.y + s * v.z, c * v.z - s * v.y};
}

dvec3 on_sphere(double azimuth, double elevation) {
    return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation),
            -std::cos(elevation) * std::cos(azimuth)};
}

dvec3 point_on(const Wall& wall, double u, double v) {
    return point(wall, u, v);
}

dvec3 point_on(const Cylinder& cylinder, double u, double v) {
    const double angle = cylinder.from + u * (cylinder.to - cylinder.from);
    return cylinder.centre + dvec3(cylinder.radius * std::sin(angle),
                                   cylinder.top + v * (cylinder.bottom - cylinder.top),
                                   -cylinder.radius * std::cos(angle));
}

dvec3 point_on(const Dome& dome, double u, double v) {
    const double azimuth = dome.from + u * (dome.to - dome.from);
    const double elevation = dome.top + v * (dome.bottom - dome.top);
    return dome.centre + dome.radius * tilted(on_sphere(azimuth, elevation), dome.tilt);
}

// Of a t^2 + 2 b t + c = 0 in front of the origin, the root whose point is nearer to `center`.
std::optional<dvec3> nearer_root(double a, double b, double c, const dvec3& origin, const dvec3& direction,
                                 const dvec3& center) {
    const double inner = b * b - a * c;
    if (!(a > 0.0 && inner >= 0.0)) return std::nullopt;
    // The root without cancellation first: the other follows from the product of both.
    const double far = -(b + std::copysign(std::sqrt(inner), b));
    const std::array<double, 2> roots{far / a, far != 0.0 ? c / far : 0.0};
    std::optional<dvec3> best;
    for (const double t : roots) {
        if (!(t > 0.0)) continue;
        const dvec3 candidate = origin + t * direction;
        if (!best || glm::distance(candidate, center) < glm::distance(*best, center)) best = candidate;
    }
    return best;
}

std::optional<dvec3> intersect(const Wall& wall, const dvec3& origin, const dvec3& direction) {
    const dvec3 normal = glm::cross(wall.across, wall.upward);
    const double t = glm::dot(wall.corner - origin, normal) / glm::dot(direction, normal);
    if (!(t > 0.0 && std::isfinite(t))) return std::nullopt;
    return origin + t * direction;
}

std::optional<dvec3> intersect(const Cylinder& cylinder, const dvec3& origin, const dvec3& direction) {
    const dvec3 horizontal(direction.x, 0.0, direction.z);
    const dvec3 from(origin.x - cylinder.centre.x, 0.0, origin.z - cylinder.centre.z);
    return nearer_root(glm::dot(horizontal, horizontal), glm::dot(from, horizontal),
                       glm::dot(from, from) - cylinder.radius * cylinder.radius, origin, direction,
                       point_on(cylinder, 0.5, 0.5));
}

std::optional<dvec3> intersect(const Dome& dome, const dvec3& origin, const dvec3& direction) {
    const dvec3 from = origin - dome.centre;
    return nearer_root(glm::dot(direction, direction), glm::dot(from, direction),
                       glm::dot(from, from) - dome.radius * dome.radius, origin, direction,
                       point_on(dome, 0.5, 0.5));
}

}  // namespace

Wall wall(const dvec3& lower_left, const dvec3& lower_right, const dvec3& upper_left,
          const std::optional<dvec3>& upper_right) {
    const auto refuse = [](const std::string& why) { throw Error(ErrorCode::InvalidInput, why); };
    const dvec3 across = lower_right - lower_left, upward = upper_left - lower_left;
    const double width = glm::length(across), height = glm::length(upward);
    if (!(width > 0.0)) refuse("lower_left and lower_right are the same point: the wall has no area");
    if (!(height > 0.0)) refuse("lower_left and upper_left are the same point: the wall has no area");
    if (!is_right_angle(across, upward)) {
        if (is_right_angle(lower_left - lower_right, upper_left - lower_right))
            refuse("the corners cross: upper_left is above lower_right; is it the upper right one?");
        const double degrees = degrees_between(across, upward);
        if (degrees < 0.5 || degrees > 179.5) refuse("the corners are collinear: the wall has no area");
        char text[120];
        std::snprintf(text, sizeof text,
                      "the edges at lower_left meet at %.1f degrees, not at 90: measure the corners again",
                      degrees);
        refuse(text);
    }
    if (upper_right) {
        if (glm::dot(*upper_right - upper_left, across) <= 0.0)
            refuse("the corners cross: upper_right is left of upper_left; exchange them");
        // Half a degree for each of the two edges.
        if (glm::distance(*upper_right, lower_right + upward) > 0.0175 * std::max(width, height))
            refuse("upper_right does not complete the rectangle: measure the corners again");
    }
    const dvec3 right = across / width;
    const dvec3 up = upward - glm::dot(upward, right) * right;
    return {lower_left, across, up * (height / glm::length(up))};
}

Wall wall_in_view(double vertical_fov, double aspect_ratio, double distance) {
    const double half = std::tan(vertical_fov / 2.0) * distance;
    return {.corner = {-half * aspect_ratio, -half, -distance},
            .across = {2.0 * half * aspect_ratio, 0.0, 0.0},
            .upward = {0.0, 2.0 * half, 0.0}};
}

dvec3 point(const Wall& wall, double u, double v) {
    return wall.corner + u * wall.across + (1.0 - v) * wall.upward;
}

dvec3 point(const Screen& screen, double u, double v) {
    return std::visit([&](const auto& shape) { return point_on(shape, u, v); }, screen);
}

std::optional<dvec3> hit(const Screen& screen, const dvec3& origin, const dvec3& direction) {
    return std::visit([&](const auto& shape) { return intersect(shape, origin, direction); }, screen);
}

ProjectionPlane projection_plane(const Wall& wall, const Part& part) {
    ProjectionPlane plane{.origin = wall.corner,
                          .right = glm::normalize(wall.across),
                          .up = glm::normalize(wall.upward),
                          .hull = {}};
    for (const double y : {part.bottom, part.top}) {
        for (const double x : {part.left, part.right})
            plane.hull.push_back(wall.corner + x * wall.across + y * wall.upward);
    }
    return plane;
}

}  // namespace tessera::display

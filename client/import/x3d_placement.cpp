#include "client/import/x3d_placement.h"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>

namespace tessera::import {
namespace {

constexpr X3dRange Scene{-1e15, 1e15};  // beyond, double precision is coarser than a centimetre

glm::dmat4 translated(const glm::dvec3& by) {
    return glm::translate(glm::dmat4(1.0), by);
}

// SFRotation: axis and angle.
glm::dmat4 rotation(const X3dFields& fields, const char* field) {
    const auto value = fields.vector(field, glm::dvec4(0.0, 0.0, 1.0, 0.0), Scene);
    const double length = glm::length(glm::dvec3(value));
    if (value.w == 0.0) return glm::dmat4(1.0);
    if (!(length > 1e-9)) {
        fields.report(std::string(field) +
                      " has an axis of length zero: the rotation is ignored, correct it");
        return glm::dmat4(1.0);
    }
    return glm::rotate(glm::dmat4(1.0), value.w, glm::dvec3(value) / length);
}

// -z along the field's direction, y up as far as possible.
glm::dmat4 looking_along(const X3dFields& fields, const char* field, const glm::dvec3& otherwise) {
    glm::dvec3 direction = fields.vector(field, otherwise, Scene);
    if (!(glm::length(direction) > 1e-9)) {
        fields.report(std::string(field) + " has length zero: its default is used, correct it");
        direction = otherwise;
    }
    const glm::dvec3 z = -glm::normalize(direction);
    const glm::dvec3 up = std::abs(z.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
    const glm::dvec3 x = glm::normalize(glm::cross(up, z));
    return {glm::dvec4(x, 0), glm::dvec4(glm::cross(z, x), 0), glm::dvec4(z, 0), glm::dvec4(0, 0, 0, 1)};
}

PlacedLight make_light(const X3dFields& fields, scene::LightKind kind) {
    PlacedLight placed;
    placed.light.kind = kind;
    // X3D says 0 to 1, but brighter lights are common.
    const double intensity = fields.flag("on", true) ? fields.number("intensity", 1.0, NotNegative) : 0.0;
    placed.light.intensity =
        glm::vec3(std::numbers::pi * intensity * fields.vector("color", glm::dvec3(1.0), NotNegative));
    return placed;
}

glm::dmat4 location(const X3dFields& fields) {
    return translated(fields.vector("location", glm::dvec3(0.0), Scene));
}

}  // namespace

glm::dmat4 transform_matrix(const X3dFields& fields) {
    const auto center = fields.vector("center", glm::dvec3(0.0), Scene);
    const glm::dmat4 orientation = rotation(fields, "scaleOrientation");
    return translated(fields.vector("translation", glm::dvec3(0.0), Scene)) * translated(center) *
           rotation(fields, "rotation") * orientation *
           glm::scale(glm::dmat4(1.0), fields.vector("scale", glm::dvec3(1.0), Scene)) *
           glm::transpose(orientation) * translated(-center);
}

PlacedLight point_light(const X3dFields& fields) {
    PlacedLight placed = make_light(fields, scene::LightKind::Point);
    placed.parent_from_light = location(fields);
    return placed;
}

PlacedLight spot_light(const X3dFields& fields) {
    PlacedLight placed = make_light(fields, scene::LightKind::Spot);
    constexpr X3dRange Angles{1e-6, std::numbers::pi / 2 + 1e-6};
    const double outer = fields.number("cutOffAngle", std::numbers::pi / 2, Angles);
    const double inner = std::min(fields.number("beamWidth", std::numbers::pi / 4, Angles), outer);
    placed.light.outer_cone_angle = static_cast<float>(outer);
    placed.light.inner_cone_angle = static_cast<float>(inner);
    placed.parent_from_light = location(fields) * looking_along(fields, "direction", {0, 0, -1});
    return placed;
}

PlacedLight directional_light(const X3dFields& fields) {
    PlacedLight placed = make_light(fields, scene::LightKind::Directional);
    placed.parent_from_light = looking_along(fields, "direction", {0, 0, -1});
    return placed;
}

PlacedViewpoint viewpoint_of(const X3dFields& fields) {
    PlacedViewpoint placed;
    placed.camera.vertical_fov =
        fields.number("fieldOfView", std::numbers::pi / 4, {1e-6, std::numbers::pi - 1e-6});
    placed.parent_from_camera =
        translated(fields.vector("position", glm::dvec3(0, 0, 10), Scene)) * rotation(fields, "orientation");
    return placed;
}

glm::dmat3 texture_transform(const X3dFields& fields) {
    constexpr X3dRange Large{-1e6, 1e6};  // beyond, coordinates lose all precision
    const auto center = fields.vector("center", glm::dvec2(0.0), Large);
    const auto scale = fields.vector("scale", glm::dvec2(1.0), Large);
    const auto translation = fields.vector("translation", glm::dvec2(0.0), Large);
    const double angle = fields.number("rotation", 0.0, Large), c = std::cos(angle), s = std::sin(angle);
    const auto moved = [](const glm::dvec2& by) { return glm::dmat3(1, 0, 0, 0, 1, 0, by.x, by.y, 1); };
    // X3D 18.4.8: -C x S x R x C x T.
    return moved(-center) * glm::dmat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, 1) *
           glm::dmat3(c, s, 0, -s, c, 0, 0, 0, 1) * moved(center) * moved(translation);
}

}  // namespace tessera::import

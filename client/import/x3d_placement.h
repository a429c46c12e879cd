#pragma once

#include <glm/mat4x4.hpp>

#include "client/import/x3d_fields.h"
#include "mediator/scene/objects.h"

namespace tessera::import {

// Parent from local: translation, center, rotation, scale and scaleOrientation of a Transform.
glm::dmat4 transform_matrix(const X3dFields& fields);

// A light or camera and its frame: both look along -z.
struct PlacedLight {
    scene::Light light;
    glm::dmat4 parent_from_light{1.0};
};
struct PlacedViewpoint {
    scene::Camera camera;
    glm::dmat4 parent_from_camera{1.0};
};

// In X3D's lighting equations a white surface facing a light of intensity 1 has the value 1; a diffuse
// surface reflects 1 / pi of the irradiance, so the light has pi W/m2 or, at 1 m, pi W/sr. Attenuation,
// radius, scope and ambient intensity are not supported: the falloff is inverse-square and unlimited. Spot
// falloff between the cone angles follows KHR_lights_punctual.
PlacedLight point_light(const X3dFields& fields);
PlacedLight spot_light(const X3dFields& fields);
PlacedLight directional_light(const X3dFields& fields);

// X3D's fieldOfView is the smaller angle, which is the vertical one in landscape format.
PlacedViewpoint viewpoint_of(const X3dFields& fields);

// Transforms texture coordinates (s, t, 1).
glm::dmat3 texture_transform(const X3dFields& fields);

}  // namespace tessera::import

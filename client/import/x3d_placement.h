#pragma once

#include <glm/mat4x4.hpp>

#include "client/import/x3d_fields.h"
#include "mediator/scene/objects.h"

namespace tessera::import {

// Translation, center, rotation, scale and scaleOrientation of a Transform, as its parent sees it.
glm::dmat4 transform_matrix(const X3dFields& fields);

// A light or camera in the frame that it needs: both look along -z.
struct PlacedLight {
    scene::Light light;
    glm::dmat4 parent_from_light{1.0};
};
struct PlacedViewpoint {
    scene::Camera camera;
    glm::dmat4 parent_from_camera{1.0};
};

// X3D's equations show a white surface that faces a light of intensity 1 as 1; a diffuse surface reflects
// 1 / pi of what arrives, so that light has pi W/m2 or, at 1 m, pi W/sr. Attenuation, radius, scope and
// ambient intensity are not read: light falls off by the square of the distance and reaches everything. A
// spot's intensity falls off between its angles as KHR_lights_punctual says.
PlacedLight point_light(const X3dFields& fields);
PlacedLight spot_light(const X3dFields& fields);
PlacedLight directional_light(const X3dFields& fields);

// fieldOfView is X3D's least angle, which is the vertical one of a picture that is wider than high.
PlacedViewpoint viewpoint_of(const X3dFields& fields);

// Texture coordinates (s, t, 1) as a TextureTransform turns them.
glm::dmat3 texture_transform(const X3dFields& fields);

}  // namespace tessera::import

#pragma once

#include <glm/vec3.hpp>

#include "client/import/scene_stats.h"

namespace tessera::import {

// The radiance, from all directions, that has the mean irradiance of the light over all directions of a surface and over
// the sphere around the bounds: irradiance on a facing surface / (4 pi). A spot light counts with its flux.
glm::dvec3 radiance_as_sky(const scene::Light& light, const glm::dmat4& world, const Bounds& bounds);

// Takes the lights that ImportOptions::lights_as_sky names, or the file marks if soft_lights_as_sky is set, out of the
// scene, and adds their radiance to the background's colour (Lardinoije 6.2). A notice says so. Throws
// Error{InvalidInput} if there is no light with such a name.
void replace_lights_by_sky(SceneBuilder& builder, const SceneStats& stats, scene::Background& background);

}  // namespace tessera::import

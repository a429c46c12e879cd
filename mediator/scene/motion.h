#pragma once

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::scene {

// The product of the transforms along a path at even steps of time after the beginning (Transform::motion);
// empty where nothing of it moves. Where one transform moves there are its own steps. Products of several
// that move are no straight lines, and those of different counts turn their corners at different times: they
// get as many steps as there may be, of which all corners are some wherever that is possible.
std::vector<glm::dmat4> motion_along(const Scene& scene, std::span<const ObjectId> path);

}  // namespace tessera::scene

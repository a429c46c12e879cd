#pragma once

#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "mediator/scene/scene.h"

namespace tessera::scene {

// The motion keys of the product of the transforms along a path (as Transform::motion); empty if none of them moves.
// With one moving transform these are at the times of its own keys. Products of several are not piecewise linear, so
// they get as many keys as allowed, at a multiple of the numbers of all transforms where possible.
std::vector<glm::dmat4> motion_along(const Scene& scene, std::span<const ObjectId> path);

}  // namespace tessera::scene

#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "client/import/import.h"

namespace tessera::import {

// What moves is looked at so often after the beginning, while the shutter is open.
inline constexpr std::size_t Looks = scene::MaxMotion;

// Of all looks, the beginning's first, the fewest steps that tell the way: 1, 3, 5 or all 15, so that steps
// of different things fall together. Straight lines between them may leave it by 1 - cos 3 degrees, as the
// chord of 6 degrees leaves its arc: of a matrix' largest element, and of the longest way that something
// goes. Without the beginning; none where nothing moves.
std::vector<glm::dmat4> steps_of(std::span<const glm::dmat4> looks);
std::vector<std::vector<glm::vec3>> steps_of(const std::vector<std::vector<glm::vec3>>& looks);

// Gives the scene's cameras the motion of their transforms.
void move_cameras(ImportedScene& scene);

}  // namespace tessera::import

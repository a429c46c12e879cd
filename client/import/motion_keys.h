#pragma once

#include <array>
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "client/import/import.h"

namespace tessera::import {

// Poses are sampled this many times while the shutter is open, not counting its opening.
inline constexpr std::size_t MotionSamples = scene::MaxMotion;

// Reduces samples (the first at the opening of the shutter) to the fewest motion keys that represent them: 1,
// 3, 5 or all 15, so that the keys of different objects coincide. The tolerance of linear interpolation is 1
// - cos 3 degrees, the distance of the chord of 6 degrees from its arc, relative to the largest matrix
// element and to the longest distance moved. Does not return the first sample; empty if nothing moves.
std::vector<glm::dmat4> motion_keys_of(std::span<const glm::dmat4> samples);
std::vector<std::vector<glm::vec3>> motion_keys_of(const std::vector<std::vector<glm::vec3>>& samples);

// Sets the motion keys of the scene's cameras from their transforms.
void move_cameras(ImportedScene& scene);

}  // namespace tessera::import

#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace tessera::import {

enum class Interpolation : std::uint8_t { Step, Linear, CubicSpline };

// A keyframed property (glTF 2.0, appendix C). Constant before the first and after the last key.
struct KeyTrack {
    Interpolation interpolation = Interpolation::Linear;
    std::size_t width = 1;      // components per value
    std::vector<float> times;   // seconds
    std::vector<float> values;  // per key: its value; CubicSpline: in-tangent, value, out-tangent
};

// Throws Error{InvalidInput} if the track is invalid: no keys, times that are not finite or not ascending,
// the wrong number of values, values that are not finite or beyond 1e15.
void check(const KeyTrack& track);
// The same, and for rotations that are not quaternions.
void check_rotation(const KeyTrack& track);

// Samples a valid track; `value` has the width of the track.
void sample(const KeyTrack& track, double seconds, std::span<double> value);

// Samples a valid rotation track as a unit quaternion x, y, z, w. Linear keys use slerp along the shorter
// arc; a spline is normalized, and where it vanishes, the previous key is used.
glm::dvec4 sample_rotation(const KeyTrack& track, double seconds);

}  // namespace tessera::import

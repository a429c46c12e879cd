#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>
#include <span>
#include <vector>

namespace tessera::import {

enum class Interpolation : std::uint8_t { Step, Linear, CubicSpline };

// A property over time, by values at keys (glTF 2.0, appendix C). Before the first key it has the first
// value, after the last the last one.
struct KeyTrack {
    Interpolation interpolation = Interpolation::Linear;
    std::size_t width = 1;      // numbers of a value
    std::vector<float> times;   // seconds
    std::vector<float> values;  // a value per key; CubicSpline: its in-tangent, itself, its out-tangent
};

// Throws Error{InvalidInput} for what cannot be sampled: no keys, times that are not finite or do not rise,
// too few values or too many, values that are not finite or beyond 1e15.
void check(const KeyTrack& track);
// The same, and for keys of a rotation that are no quaternions.
void check_rotation(const KeyTrack& track);

// A track that passed its check, at a time; `value` has its width.
void sample(const KeyTrack& track, double seconds, std::span<double> value);

// A unit quaternion x, y, z, w. Linear keys are joined by the shorter great arc at even speed; a spline is
// normalised, and where it passes through zero, the key before counts.
glm::dvec4 sample_rotation(const KeyTrack& track, double seconds);

}  // namespace tessera::import

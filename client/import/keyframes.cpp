#include "client/import/keyframes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <string>

#include "client/import/reject.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

constexpr float Largest = 1e15f;  // the scene's bound on translations
constexpr double MinQuaternionLength =
    1e-9;  // length of a quaternion; below, its direction is rounding error

// A time between key and key + 1, at the fraction `part`.
struct KeySpan {
    std::size_t key = 0;
    double part = 0.0;
    double seconds = 0.0;  // from key to key + 1
};

KeySpan locate(const KeyTrack& track, double seconds) {
    const auto& times = track.times;
    if (!(seconds > times.front())) return {};
    if (seconds >= times.back()) return {.key = times.size() - 1};
    const auto next = std::upper_bound(times.begin(), times.end(), seconds,
                                       [](double wanted, float time) { return wanted < double(time); });
    const std::size_t key = static_cast<std::size_t>(next - times.begin()) - 1;
    const double length = double(times[key + 1]) - double(times[key]);
    return {.key = key, .part = (seconds - double(times[key])) / length, .seconds = length};
}

// The parts of a spline key; other tracks only have values.
enum class Part : std::size_t { InTangent, Value, OutTangent };

const float* part_of(const KeyTrack& track, std::size_t key, Part part) {
    const bool spline = track.interpolation == Interpolation::CubicSpline;
    return &track.values[(spline ? key * 3 + static_cast<std::size_t>(part) : key) * track.width];
}

glm::dvec4 quaternion(const float* from) {
    return {from[0], from[1], from[2], from[3]};
}

}  // namespace

void check(const KeyTrack& track) {
    if (track.times.empty()) reject("it has no keys");
    for (std::size_t i = 0; i < track.times.size(); ++i) {
        if (!std::isfinite(track.times[i])) reject("the time of key " + std::to_string(i) + " is not finite");
        if (i > 0 && !(track.times[i] > track.times[i - 1]))
            reject("the time of key " + std::to_string(i) + " is not after that of the key before");
    }
    const std::size_t per_key = track.width * (track.interpolation == Interpolation::CubicSpline ? 3 : 1);
    if (track.values.size() != track.times.size() * per_key) {
        reject("it has " + std::to_string(track.values.size()) + " values, but " +
               std::to_string(track.times.size()) + " keys need " +
               std::to_string(track.times.size() * per_key));
    }
    for (const float value : track.values) {
        if (!(std::abs(value) < Largest)) reject("a value is not finite or beyond 1e15");
    }
}

void check_rotation(const KeyTrack& track) {
    check(track);
    for (std::size_t i = 0; i < track.times.size(); ++i) {
        if (!(glm::length(quaternion(part_of(track, i, Part::Value))) > MinQuaternionLength))
            reject("the rotation of key " + std::to_string(i) + " is not a quaternion");
    }
}

void sample(const KeyTrack& track, double seconds, std::span<double> value) {
    const KeySpan at = locate(track, seconds);
    const float* here = part_of(track, at.key, Part::Value);
    if (at.part == 0.0 || track.interpolation == Interpolation::Step) {
        std::copy_n(here, track.width, value.begin());
        return;
    }
    const float* next = part_of(track, at.key + 1, Part::Value);
    const double t = at.part;
    if (track.interpolation == Interpolation::Linear) {
        for (std::size_t i = 0; i < track.width; ++i)
            value[i] = double(here[i]) * (1.0 - t) + double(next[i]) * t;
        return;
    }
    const float* out = part_of(track, at.key, Part::OutTangent);
    const float* in = part_of(track, at.key + 1, Part::InTangent);
    const double t2 = t * t, t3 = t2 * t;
    for (std::size_t i = 0; i < track.width; ++i) {
        value[i] = (2.0 * t3 - 3.0 * t2 + 1.0) * double(here[i]) +
                   at.seconds * (t3 - 2.0 * t2 + t) * double(out[i]) +
                   (3.0 * t2 - 2.0 * t3) * double(next[i]) + at.seconds * (t3 - t2) * double(in[i]);
    }
}

glm::dvec4 sample_rotation(const KeyTrack& track, double seconds) {
    const KeySpan at = locate(track, seconds);
    const glm::dvec4 here = glm::normalize(quaternion(part_of(track, at.key, Part::Value)));
    if (at.part == 0.0 || track.interpolation == Interpolation::Step) return here;
    if (track.interpolation == Interpolation::CubicSpline) {
        std::array<double, 4> value;
        sample(track, seconds, value);
        const glm::dvec4 turn(value[0], value[1], value[2], value[3]);
        const double length = glm::length(turn);
        return length > MinQuaternionLength ? turn / length : here;
    }
    glm::dvec4 next = glm::normalize(quaternion(part_of(track, at.key + 1, Part::Value)));
    if (glm::dot(here, next) < 0.0) next = -next;  // the same rotation, along the shorter arc
    const double angle = 2.0 * std::atan2(glm::length(next - here), glm::length(next + here));
    // Below, the arc and its chord are the same in double.
    if (angle < 1e-8) return glm::normalize(here * (1.0 - at.part) + next * at.part);
    return glm::normalize((here * std::sin((1.0 - at.part) * angle) + next * std::sin(at.part * angle)) /
                          std::sin(angle));
}

}  // namespace tessera::import

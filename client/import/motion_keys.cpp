#include "client/import/motion_keys.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/trigonometric.hpp>

#include "mediator/view/placed_cameras.h"

namespace tessera::import {
namespace {

// The least number of keys so that linear interpolation between every (MotionSamples / keys)-th sample stays
// near the other samples. `deviates(i, a, b, fraction)`: whether sample i is too far from the interpolation
// between samples a and b at that fraction.
template <class Deviates>
std::size_t count_keys(const Deviates& deviates) {
    for (const std::size_t keys : {1, 3, 5}) {
        const std::size_t stride = MotionSamples / keys;
        bool fits = true;
        for (std::size_t i = 0; i <= MotionSamples && fits; ++i) {
            const std::size_t a = std::min(i / stride, keys - 1) * stride;
            fits = !deviates(i, a, a + stride, double(i - a) / double(stride));
        }
        if (fits) return keys;
    }
    return MotionSamples;
}

template <class T>
std::vector<T> chosen(std::span<const T> samples, std::size_t keys) {
    std::vector<T> result;
    for (std::size_t i = 1; i <= keys; ++i) result.push_back(samples[i * (MotionSamples / keys)]);
    return result;
}

double tolerance() {
    return 1.0 - std::cos(glm::radians(3.0));
}

}  // namespace

std::vector<glm::dmat4> motion_keys_of(std::span<const glm::dmat4> samples) {
    double size = 0.0, distance = 0.0;
    bool is_moving = false;
    for (const glm::dmat4& sample : samples) {
        is_moving = is_moving || sample != samples[0];
        for (int column = 0; column < 3; ++column) {
            for (int row = 0; row < 3; ++row) size = std::max(size, std::abs(sample[column][row]));
        }
        distance = std::max(distance, glm::distance(sample[3], samples[0][3]));
    }
    if (!is_moving) return {};
    const auto deviates = [&](std::size_t i, std::size_t a, std::size_t b, double fraction) {
        const glm::dmat4 off = samples[a] + (samples[b] - samples[a]) * fraction - samples[i];
        double linear = 0.0;
        for (int column = 0; column < 3; ++column) linear = std::max(linear, glm::length(off[column]));
        // The last term allows for rounding of the samples.
        return linear > tolerance() * size ||
               glm::length(off[3]) > tolerance() * distance + 1e-12 * glm::length(samples[i][3]);
    };
    return chosen(samples, count_keys(deviates));
}

std::vector<std::vector<glm::vec3>> motion_keys_of(const std::vector<std::vector<glm::vec3>>& samples) {
    float distance = 0.0f;
    for (const auto& sample : samples) {
        for (std::size_t v = 0; v < sample.size(); ++v)
            distance = std::max(distance, glm::distance(sample[v], samples[0][v]));
    }
    if (!(distance > 0.0f)) return {};
    const auto deviates = [&](std::size_t i, std::size_t a, std::size_t b, double fraction) {
        for (std::size_t v = 0; v < samples[i].size(); ++v) {
            const glm::vec3 straight = samples[a][v] + (samples[b][v] - samples[a][v]) * float(fraction);
            if (glm::distance(straight, samples[i][v]) > float(tolerance()) * distance) return true;
        }
        return false;
    };
    return chosen(std::span(samples), count_keys(deviates));
}

void move_cameras(ImportedScene& imported) {
    scene::Scene scene;
    if (!scene.apply_entries(entries(imported, RootEntry::Create))) return;
    for (const view::PlacedCamera& placed : view::placed_cameras(scene)) {
        for (CameraInfo& camera : imported.cameras) {
            if (camera.name == placed.name) camera.motion = placed.motion;
        }
    }
}

}  // namespace tessera::import

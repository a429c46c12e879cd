#pragma once

#include <glm/vec3.hpp>
#include <optional>

#include "tests/filter/synthetic.h"

namespace tessera::filter {

// A wall and, in front of it, a square board (object 2), as an analytic scene for pinholes. Textured albedo;
// the irradiance is the probability that a sample finds the light, times the light's strength.
struct PlanesScene {
    glm::dvec3 origin{0.0};           // of the whole scene
    double wall = 10.0, board = 5.0;  // distances along -z from the origin
    double board_half = 1.0, board_x = 0.0;
    double tilt = 0.0;      // of the wall: change of z per unit of x
    double shadow_x = 1e9;  // the wall is in shadow (a tenth of the light) on this side and beyond
    float strength = 1.0f;
    bool textured = true;

    struct Hit {
        glm::dvec3 point;  // relative to the origin
        glm::vec3 normal;
        float albedo = 0.0f, chance = 0.0f;
        std::uint32_t object = 0;
        double depth = 0.0;
    };
    // Of the ray through (x, y) of a picture, in pixels.
    std::optional<Hit> trace(const view::CameraPose& camera, std::uint32_t width, std::uint32_t height,
                             double x, double y) const;
};

// A camera at origin + offset facing -z, rotated by `yaw` about y.
view::CameraPose looking_at(const PlanesScene& scene, glm::dvec3 offset, std::uint32_t width,
                            std::uint32_t height, double yaw = 0.0);

struct Shot {
    std::uint32_t width = 96, height = 64;
    std::uint64_t n = 1, seed = 1;
    double coverage = 1.0;  // probability that a pixel has samples
    bool noise = true;      // otherwise every sample is the expectation
    bool jitter = false;    // samples anywhere in the pixel, not in its centre
};
Inputs photograph(const PlanesScene& scene, const view::CameraPose& camera, const Shot& shot);

// The limit of samples at the pixel centres: 3 components.
Planes truth_of(const PlanesScene& scene, const view::CameraPose& camera, std::uint32_t width,
                std::uint32_t height);

}  // namespace tessera::filter

#pragma once

#include <functional>

#include "tests/filter/synthetic.h"

namespace tessera::filter {

// One synthetic pixel for the pixel filter.
struct PixelLight {
    float high = 0.0f, variance = 0.0f;  // grey; of the mean
    float headlight = 0.5f, depth = 1.0f;
    float n = 4.0f;
    float low = 0.0f, alpha = 1.0f, normal_z = 1.0f;
};

// Inputs built directly from these values, without samples.
Inputs pixel_inputs(std::uint32_t width, std::uint32_t height,
                    const std::function<PixelLight(std::uint32_t x, std::uint32_t y)>& light);

// A threshold so low that s = 0 and the picture is the filtered light alone.
inline const std::string FilteredLight = "pixel:blend=off,t=0.000001,adaptive=off,spike_clamp=0";

const Planes& map_of(const Output& out, const std::string& name);

// Uniform in [0, 1), a pure function of its arguments.
float noise(std::uint64_t seed, std::uint32_t x, std::uint32_t y);

// Mean of (a - b)^2 / (b^2 + 0.01).
double relative_error(const Planes& a, const Planes& b);

}  // namespace tessera::filter

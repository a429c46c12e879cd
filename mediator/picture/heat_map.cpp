#include "mediator/picture/heat_map.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera::picture {

namespace {

using Rgb = std::array<float, 3>;

// Linear; the luminance rises by the same factor of lightness from each to the next.
constexpr std::array<Rgb, 6> Ramp{{{0.0f, 0.0f, 0.0f},
                                   {0.020f, 0.007f, 0.120f},
                                   {0.180f, 0.015f, 0.180f},
                                   {0.680f, 0.055f, 0.060f},
                                   {0.950f, 0.350f, 0.030f},
                                   {1.0f, 1.0f, 1.0f}}};

Rgb color(float position) {
    const float along = position * float(Ramp.size() - 1);
    const auto from = std::min(static_cast<std::size_t>(along), Ramp.size() - 2);
    const float part = along - float(from);
    Rgb result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = Ramp[from][c] + part * (Ramp[from + 1][c] - Ramp[from][c]);
    return result;
}

}  // namespace

frame::Image heat_map(std::span<const float> values, std::uint32_t width, std::uint32_t height, float low,
                      float high) {
    frame::Image image(width, height, 3);
    const float decades = std::log(high / low);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const float value = std::clamp(values[i], low, high);  // not a number: black
        const Rgb rgb = color(value > low ? std::min(std::log(value / low) / decades, 1.0f) : 0.0f);
        std::copy(rgb.begin(), rgb.end(), image.pixel(i).begin());
    }
    return image;
}

}  // namespace tessera::picture

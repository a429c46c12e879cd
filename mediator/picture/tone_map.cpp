#include "mediator/picture/tone_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/picture/color.h"

namespace tessera::picture {

namespace {

double usable(float value) {
    return std::isfinite(value) && value > 0.0f ? static_cast<double>(value) : 0.0;
}

double luminance_of(const std::array<double, 3>& c) {
    return luminance(c[0], c[1], c[2]);
}

std::array<double, 3> pixel(const frame::Image& image, std::size_t i) {
    const auto p = image.pixel(i);
    return {usable(p[0]), usable(p[1]), usable(p[2])};
}

std::uint8_t encode(double linear) {
    return static_cast<std::uint8_t>(std::lround(srgb_from_linear(std::clamp(linear, 0.0, 1.0)) * 255.0));
}

// Black pixels say nothing about the exposure: they are left out of the mean instead of being given a made-up
// floor.
struct Range {
    double log_mean = 0.0, largest = 0.0;
    bool black = true;
};
Range range_of(const frame::Image& image) {
    Range range;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const double l = luminance_of(pixel(image, i));
        if (!(l > 0.0)) continue;
        sum += std::log(l);
        range.largest = std::max(range.largest, l);
        ++count;
    }
    range.black = count == 0;
    if (count > 0) range.log_mean = std::exp(sum / static_cast<double>(count));
    return range;
}

}  // namespace

std::vector<std::uint8_t> tone_map(const frame::Image& image, const ToneMapping& mapping) {
    std::vector<std::uint8_t> bytes(image.pixel_count() * 3, 0);
    const Range range = range_of(image);
    if (range.black) return bytes;
    const double scale = mapping.key / range.log_mean *
                         std::exp2(std::clamp(static_cast<double>(mapping.exposure), -100.0, 100.0));
    const double white = mapping.white > 0.0f ? mapping.white : std::max(range.largest * scale, 1.0);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const std::array<double, 3> color = pixel(image, i);
        const double l = luminance_of(color) * scale;
        const double factor = scale * (1.0 + l / (white * white)) / (1.0 + l);
        for (std::size_t c = 0; c < 3; ++c) bytes[3 * i + c] = encode(color[c] * factor);
    }
    return bytes;
}

}  // namespace tessera::picture

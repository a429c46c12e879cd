#include "tests/bench/filters/display.h"

#include <algorithm>
#include <cmath>

#include "mediator/picture/color.h"

namespace tessera::tools::bench {

namespace {

double usable(float value) {
    return std::isfinite(value) && value > 0.0f ? static_cast<double>(value) : 0.0;
}

}  // namespace

// White is the 99th percentile: a single lamp in the picture must not darken the rest.
Display::Display(const frame::Image& reference) {
    constexpr double Key = 0.18;
    double sum = 0.0;
    std::vector<double> bright;
    for (std::size_t i = 0; i < reference.pixel_count(); ++i) {
        const auto p = reference.pixel(i);
        const double l = picture::luminance(usable(p[0]), usable(p[1]), usable(p[2]));
        if (!(l > 0.0)) continue;
        sum += std::log(l);
        bright.push_back(l);
    }
    if (bright.empty()) return;
    scale_ = Key / std::exp(sum / static_cast<double>(bright.size()));
    const auto percentile = bright.begin() + static_cast<std::ptrdiff_t>(bright.size() * 99 / 100);
    std::nth_element(bright.begin(), percentile, bright.end());
    white_ = std::max(1.0, *percentile * scale_);
}

frame::Image Display::shown(const frame::Image& picture) const {
    frame::Image result(picture.width, picture.height, 3);
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        const auto p = picture.pixel(i);
        const double l = picture::luminance(usable(p[0]), usable(p[1]), usable(p[2])) * scale_;
        const double factor = scale_ * (1.0 + l / (white_ * white_)) / (1.0 + l);
        for (std::size_t c = 0; c < 3; ++c) {
            result.values[3 * i + c] = static_cast<float>(std::min(1.0, usable(p[c]) * factor));
        }
    }
    return result;
}

std::vector<std::uint8_t> Display::pixels(const frame::Image& picture) const {
    const frame::Image linear = shown(picture);
    std::vector<std::uint8_t> bytes(linear.values.size());
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        bytes[i] =
            static_cast<std::uint8_t>(std::lround(picture::srgb_from_linear(linear.values[i]) * 255.0));
    }
    return bytes;
}

}  // namespace tessera::tools::bench

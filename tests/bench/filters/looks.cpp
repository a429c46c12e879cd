#include "tests/bench/filters/looks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mediator/picture/color.h"
#include "mediator/picture/same_size.h"

namespace tessera::tools::bench {

namespace {

std::vector<float> luminances(const frame::Image& picture) {
    std::vector<float> values(picture.pixel_count());
    for (std::size_t i = 0; i < values.size(); ++i) {
        const auto p = picture.pixel(i);
        values[i] = static_cast<float>(picture::luminance(p[0], p[1], p[2]));
    }
    return values;
}

// Of the up to 5 x 5 pixels around each.
std::vector<float> medians(const std::vector<float>& values, std::int32_t width, std::int32_t height) {
    std::vector<float> result(values.size());
    std::array<float, 25> window{};
    for (std::int32_t y = 0; y < height; ++y) {
        for (std::int32_t x = 0; x < width; ++x) {
            auto end = window.begin();
            for (std::int32_t v = std::max(0, y - 2); v <= std::min(height - 1, y + 2); ++v) {
                for (std::int32_t u = std::max(0, x - 2); u <= std::min(width - 1, x + 2); ++u)
                    *end++ = values[static_cast<std::size_t>(v) * width + u];
            }
            const auto middle = window.begin() + (end - window.begin()) / 2;
            std::nth_element(window.begin(), middle, end);
            result[static_cast<std::size_t>(y) * width + x] = *middle;
        }
    }
    return result;
}

std::vector<bool> standing_out(const frame::Image& picture, double mean) {
    const std::vector<float> values = luminances(picture);
    const std::vector<float> around =
        medians(values, static_cast<std::int32_t>(picture.width), static_cast<std::int32_t>(picture.height));
    std::vector<bool> result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        result[i] = std::fabs(double(values[i]) - around[i]) > 0.25 * around[i] + 0.01 * mean;
    return result;
}

}  // namespace

double mean_luminance(const frame::Image& picture) {
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
        const auto p = picture.pixel(i);
        sum += picture::luminance(p[0], p[1], p[2]);
    }
    return picture.pixel_count() == 0 ? 0.0 : sum / static_cast<double>(picture.pixel_count());
}

double speck_fraction(const frame::Image& picture, const frame::Image& reference) {
    picture::require_same_size(picture, reference);
    if (picture.pixel_count() == 0) return 0.0;
    const double mean = mean_luminance(reference);
    const std::vector<bool> specks = standing_out(picture, mean), real = standing_out(reference, mean);
    std::size_t count = 0;
    for (std::size_t i = 0; i < specks.size(); ++i) count += specks[i] && !real[i] ? 1u : 0u;
    return double(count) / double(specks.size());
}

}  // namespace tessera::tools::bench

#include "tests/bench/filters/crops.h"

#include <algorithm>
#include <cmath>

#include "mediator/picture/convolution.h"

namespace tessera::tools::bench {

namespace {

// The displayed picture, smoothed to remove remaining noise.
picture::Plane smoothed(const frame::Image& reference) {
    const frame::Image shown = Display(reference).shown(reference);
    picture::Plane plane(reference.width, reference.height);
    for (std::size_t i = 0; i < plane.values.size(); ++i) plane.values[i] = std::sqrt(shown.pixel(i)[1]);
    const picture::Kernel kernel = picture::gaussian(2.0, 5);
    return picture::convolve(plane, kernel, kernel);
}

}  // namespace

Rect most_detailed(const frame::Image& reference, std::int32_t width, std::int32_t height) {
    const auto whole_width = static_cast<std::int32_t>(reference.width);
    const auto whole_height = static_cast<std::int32_t>(reference.height);
    width = std::min(width, whole_width);
    height = std::min(height, whole_height);
    const picture::Plane seen = smoothed(reference);
    const auto at = [&](std::int32_t x, std::int32_t y) {
        return seen.values[static_cast<std::size_t>(y) * seen.width + static_cast<std::size_t>(x)];
    };
    const std::int32_t step = std::max(1, std::min(width, height) / 8);
    Rect best{0, 0, width, height};
    double most = -1.0;
    for (std::int32_t top = 0; top + height <= whole_height; top += step) {
        for (std::int32_t left = 0; left + width <= whole_width; left += step) {
            double detail = 0.0;
            for (std::int32_t y = top; y + 2 < top + height; y += 2) {
                for (std::int32_t x = left; x + 2 < left + width; x += 2) {
                    // Clamped, so that bright edges do not dominate.
                    detail +=
                        std::min(0.1f, std::abs(at(x + 2, y) - at(x, y)) + std::abs(at(x, y + 2) - at(x, y)));
                }
            }
            if (detail <= most) continue;
            most = detail;
            best = {left, top, width, height};
        }
    }
    return best;
}

frame::Image cropped(const frame::Image& picture, const Rect& crop) {
    frame::Image result(static_cast<std::uint32_t>(crop.width), static_cast<std::uint32_t>(crop.height),
                        picture.components);
    const std::size_t row_values = std::size_t{result.width} * picture.components;
    for (std::int32_t y = 0; y < crop.height; ++y) {
        const std::size_t from =
            static_cast<std::size_t>(crop.y + y) * picture.width + static_cast<std::size_t>(crop.x);
        std::copy_n(
            picture.values.begin() + static_cast<std::ptrdiff_t>(from * picture.components), row_values,
            result.values.begin() + static_cast<std::ptrdiff_t>(static_cast<std::size_t>(y) * row_values));
    }
    return result;
}

}  // namespace tessera::tools::bench

#include "mediator/picture/exposure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mediator/picture/color.h"

namespace tessera::picture {

std::optional<double> measured_exposure(const frame::Image& image) {
    constexpr double MiddleGrey = 0.18, Darkest = 0.1, Brightest = 0.05;
    constexpr double Highlight = 0.8, Highlights = 0.2;
    std::vector<float> logs;
    logs.reserve(image.pixel_count());
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const auto pixel = image.pixel(i);
        if (image.components == 4 && !(pixel[3] > 0.5f)) continue;
        const double y = luminance(pixel[0], pixel[1], pixel[2]);
        if (y > 0.0 && std::isfinite(y)) logs.push_back(static_cast<float>(std::log2(y)));
    }
    if (logs.empty()) return std::nullopt;
    const auto count = static_cast<double>(logs.size());
    const auto first = logs.begin() + static_cast<std::ptrdiff_t>(Darkest * count);
    const auto last = logs.end() - static_cast<std::ptrdiff_t>(Brightest * count);
    std::nth_element(logs.begin(), first, logs.end());
    if (last != logs.end()) std::nth_element(first, last, logs.end());
    double sum = 0.0;
    for (auto log = first; log != last; ++log) sum += double{*log};
    const double of_mean = std::log2(MiddleGrey) - sum / static_cast<double>(last - first);
    const auto highlight = logs.end() - 1 - static_cast<std::ptrdiff_t>(Highlights * count);
    std::nth_element(logs.begin(), highlight, logs.end());
    const double exposure = std::min(of_mean, std::log2(Highlight) - double{*highlight});
    return std::clamp(exposure, -view::MaxExposure, view::MaxExposure);
}

view::DisplayTransform with_exposure(view::DisplayTransform transform, const frame::Image& image) {
    if (!transform.exposure) transform.exposure = measured_exposure(image).value_or(0.0);
    return transform;
}

}  // namespace tessera::picture

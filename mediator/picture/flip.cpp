#include "mediator/picture/flip.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "mediator/picture/color.h"
#include "mediator/picture/flip_map.h"
#include "mediator/picture/same_size.h"

namespace tessera::picture {

namespace {

// ACES as fitted by Narkowicz (2015), with the exposure of 0.6 folded in: the tone mapper of HDR-FLIP.
constexpr double K0 = 0.6 * 0.6 * 2.51, K1 = 0.6 * 0.03, K3 = 0.6 * 0.6 * 2.43, K4 = 0.6 * 0.59, K5 = 0.14;
constexpr double Target = 0.85;  // t: what the brightest and the median luminance map to at the two ends
constexpr double MinMedian = std::numeric_limits<float>::epsilon();  // of a mostly black reference

double aces(double x) {
    if (x > 1e6) return 1.0;  // beyond 1 already; avoids overflow of the squares
    return std::clamp((K0 * x * x + K1 * x) / (K3 * x * x + K4 * x + K5), 0.0, 1.0);
}

// The x > 0 with aces(x) = Target.
double target_luminance() {
    const double a = K0 - Target * K3, b = K1 - Target * K4, c = -Target * K5;
    return (-b + std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
}

double finite_positive(float value) {
    return value > 0.0f ? std::min(value, std::numeric_limits<float>::max()) : 0.0f;
}

double component(const frame::Image& image, std::size_t pixel, std::size_t c) {
    return finite_positive(image.pixel(pixel)[image.components == 1 ? 0 : c]);
}

template <class Curve>
RgbPlanes shown(const frame::Image& image, const Curve& curve) {
    RgbPlanes planes;
    for (std::size_t c = 0; c < 3; ++c) {
        planes[c] = Plane(image.width, image.height);
        for (std::size_t i = 0; i < image.pixel_count(); ++i)
            planes[c].values[i] = static_cast<float>(curve(component(image, i, c)));
    }
    return planes;
}

double mean(const Plane& plane) {
    return std::accumulate(plane.values.begin(), plane.values.end(), 0.0) /
           static_cast<double>(plane.values.size());
}

void require_comparable(const frame::Image& picture, const frame::Image& reference) {
    require_same_size(picture, reference);
    if (picture.components != 1 && picture.components != 3) {
        throw Error(ErrorCode::InvalidInput, "the pictures have " + std::to_string(picture.components) +
                                                 " components: flip compares one or three");
    }
}

struct Exposures {
    double start = 0.0, step = 0.0;  // in stops
    int count = 2;
};
Exposures exposures_for(const frame::Image& reference) {
    std::vector<double> luminances(reference.pixel_count());
    for (std::size_t i = 0; i < luminances.size(); ++i)
        luminances[i] =
            luminance(component(reference, i, 0), component(reference, i, 1), component(reference, i, 2));
    const double largest = std::max(*std::max_element(luminances.begin(), luminances.end()), MinMedian);
    const auto median = luminances.begin() + static_cast<std::ptrdiff_t>(luminances.size() / 2);
    std::nth_element(luminances.begin(), median, luminances.end());
    const double start = std::log2(target_luminance() / largest);
    const double stop = std::log2(target_luminance() / std::max(*median, MinMedian));
    Exposures exposures{.start = start, .count = std::max(2, static_cast<int>(std::ceil(stop - start)))};
    exposures.step = (stop - start) / (exposures.count - 1);
    return exposures;
}

}  // namespace

double ldr_flip_mean(const frame::Image& picture, const frame::Image& reference) {
    require_comparable(picture, reference);
    const auto clipped = [](double c) { return std::min(c, 1.0); };
    return mean(flip_map(shown(picture, clipped), shown(reference, clipped)));
}

double hdr_flip_mean(const frame::Image& picture, const frame::Image& reference) {
    require_comparable(picture, reference);
    const Exposures exposures = exposures_for(reference);
    Plane largest(picture.width, picture.height);
    for (int e = 0; e < exposures.count; ++e) {
        const double scale = std::exp2(exposures.start + e * exposures.step);
        const auto mapped = [&](double c) { return aces(c * scale); };
        const Plane map = flip_map(shown(picture, mapped), shown(reference, mapped));
        for (std::size_t i = 0; i < largest.values.size(); ++i)
            largest.values[i] = std::max(largest.values[i], map.values[i]);
    }
    return mean(largest);
}

}  // namespace tessera::picture

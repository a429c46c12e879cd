#include "mediator/picture/metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mediator/picture/color.h"
#include "mediator/picture/convolution.h"
#include "mediator/picture/same_size.h"

namespace tessera::picture {

namespace {

double difference(float x, float r) {
    return x == r ? 0.0 : static_cast<double>(x) - static_cast<double>(r);
}

double luminance_of(const frame::Image& image, std::size_t pixel) {
    const auto p = image.pixel(pixel);
    if (p.size() == 3) return luminance(p[0], p[1], p[2]);
    double sum = 0.0;
    for (const float value : p) sum += value;
    return sum / static_cast<double>(p.size());
}

double mean_luminance(const frame::Image& image) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const double l = luminance_of(image, i);
        if (!std::isfinite(l)) continue;
        sum += l;
        ++count;
    }
    return count == 0 ? 0.0 : sum / static_cast<double>(count);
}

template <class Term>
double mean_over_values(const frame::Image& picture, const frame::Image& reference, const Term& term) {
    require_same_size(picture, reference);
    double sum = 0.0;
    for (std::size_t i = 0; i < picture.values.size(); ++i)
        sum += term(picture.values[i], reference.values[i]);
    return sum / static_cast<double>(picture.values.size());
}

double display_scale(const frame::Image& reference) {
    constexpr double Key = 0.18;
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < reference.pixel_count(); ++i) {
        const double l = luminance_of(reference, i);
        if (!std::isfinite(l) || l <= 0.0) continue;
        sum += std::log(l);
        ++count;
    }
    return count == 0 ? 1.0 : Key / std::exp(sum / static_cast<double>(count));
}

double display_value(float value, double scale) {
    if (!(value > 0.0f)) return 0.0;
    const double c = std::min(value, std::numeric_limits<float>::max()) * scale;
    return srgb_from_linear(c / (1.0 + c));
}

Plane display_luminance(const frame::Image& image, double scale) {
    Plane plane(image.width, image.height);
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const auto p = image.pixel(i);
        double sum = 0.0;
        for (const float value : p) sum += display_value(value, scale);
        plane.values[i] = static_cast<float>(p.size() == 3 ? luminance(display_value(p[0], scale),
                                                                       display_value(p[1], scale),
                                                                       display_value(p[2], scale))
                                                           : sum / static_cast<double>(p.size()));
    }
    return plane;
}

Plane product(const Plane& a, const Plane& b) {
    Plane result(a.width, a.height);
    for (std::size_t i = 0; i < a.values.size(); ++i) result.values[i] = a.values[i] * b.values[i];
    return result;
}

}  // namespace

double mse(const frame::Image& picture, const frame::Image& reference) {
    return mean_over_values(picture, reference, [](float x, float r) {
        const double d = difference(x, r);
        return d * d;
    });
}

double relmse(const frame::Image& picture, const frame::Image& reference) {
    const double mean = mean_luminance(reference);
    const double epsilon = 0.01 * mean * mean;
    return mean_over_values(picture, reference, [&](float x, float r) {
        const double d = difference(x, r);
        return d == 0.0 ? 0.0 : d * d / (static_cast<double>(r) * r + epsilon);
    });
}

double psnr(const frame::Image& picture, const frame::Image& reference) {
    const double scale = display_scale(reference);
    const double error = mean_over_values(picture, reference, [&](float x, float r) {
        const double d = display_value(x, scale) - display_value(r, scale);
        return d * d;
    });
    return -10.0 * std::log10(error);
}

double ssim(const frame::Image& picture, const frame::Image& reference) {
    require_same_size(picture, reference);
    constexpr double C1 = 0.01 * 0.01, C2 = 0.03 * 0.03;  // (K L)^2 with L = 1
    const double scale = display_scale(reference);
    const Plane x = display_luminance(picture, scale), r = display_luminance(reference, scale);
    const Kernel window = gaussian(1.5, 5);
    const auto blurred = [&](const Plane& plane) { return convolve(plane, window, window).values; };
    const auto mean_x = blurred(x), mean_r = blurred(r);
    const auto xx = blurred(product(x, x)), rr = blurred(product(r, r)), xr = blurred(product(x, r));
    double sum = 0.0;
    for (std::size_t i = 0; i < mean_x.size(); ++i) {
        const double mx = mean_x[i], mr = mean_r[i];
        const double variance_x = xx[i] - mx * mx, variance_r = rr[i] - mr * mr, covariance = xr[i] - mx * mr;
        sum += (2.0 * mx * mr + C1) * (2.0 * covariance + C2) /
               ((mx * mx + mr * mr + C1) * (variance_x + variance_r + C2));
    }
    return sum / static_cast<double>(mean_x.size());
}

}  // namespace tessera::picture

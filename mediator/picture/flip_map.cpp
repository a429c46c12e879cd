#include "mediator/picture/flip_map.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "mediator/picture/flip_features.h"

namespace tessera::picture {

namespace {

using std::numbers::pi;

constexpr double PixelsPerDegree = 0.7 * (3840.0 / 0.7) * (pi / 180.0);
constexpr double ColorExponent = 0.7;   // q_c
constexpr double LargeError = 0.4;      // p_c: the part of the largest colour difference from which on ...
constexpr double LargeErrorMap = 0.95;  // p_t: ... the range above this is used

// Contrast sensitivity as a sum of a_i sqrt(pi / b_i) exp(-pi^2 x^2 / b_i), x in degrees (table 1).
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr Sensitivity Achromatic{1.0, 0.0047, 0.0, 1e-5};
constexpr Sensitivity RedGreen{1.0, 0.0053, 0.0, 1e-5};
constexpr Sensitivity BlueYellow{34.1, 0.04, 13.5, 0.025};
constexpr double WidestTerm = 0.04;

// Columns of the matrix from linear Rec. 709 to XYZ; white is the sum of the columns (D65).
const glm::dmat3 XyzFromRgb{{10135552.0 / 24577794, 2613072.0 / 12288897, 1425312.0 / 73733382},
                            {8788810.0 / 24577794, 8788810.0 / 12288897, 8788810.0 / 73733382},
                            {4435075.0 / 24577794, 887015.0 / 12288897, 70074185.0 / 73733382}};
const glm::dmat3 RgbFromXyz = glm::inverse(XyzFromRgb);
const glm::dvec3 White = XyzFromRgb * glm::dvec3(1.0);

// YCxCz, the linear opponent space in which the eye's filters work.
glm::dvec3 opponent_from_rgb(const glm::dvec3& rgb) {
    const glm::dvec3 n = (XyzFromRgb * rgb) / White;
    return {116.0 * n.y - 16.0, 500.0 * (n.x - n.y), 200.0 * (n.y - n.z)};
}

glm::dvec3 rgb_from_opponent(const glm::dvec3& ycxcz) {
    const double y = (ycxcz.x + 16.0) / 116.0;
    return RgbFromXyz * (glm::dvec3(y + ycxcz.y / 500.0, y, y - ycxcz.z / 200.0) * White);
}

// CIELAB with chroma scaled by lightness (Hunt: colours fade in the dark).
glm::dvec3 hunt_lab_from_rgb(const glm::dvec3& rgb) {
    const glm::dvec3 n = (XyzFromRgb * rgb) / White;
    constexpr double Delta = 6.0 / 29.0;
    const auto f = [](double t) {
        return t > Delta * Delta * Delta ? std::cbrt(t) : t / (3.0 * Delta * Delta) + 4.0 / 29.0;
    };
    const double lightness = 116.0 * f(n.y) - 16.0;
    return {lightness, 0.01 * lightness * 500.0 * (f(n.x) - f(n.y)),
            0.01 * lightness * 200.0 * (f(n.y) - f(n.z))};
}

double hyab(const glm::dvec3& a, const glm::dvec3& b) {
    return std::abs(a.x - b.x) + std::hypot(a.y - b.y, a.z - b.z);
}

// The largest difference, of green and blue, maps to 1; most of [0, 1] is kept for the common small ones.
double redistributed(double difference) {
    static const double Largest =
        std::pow(hyab(hunt_lab_from_rgb({0, 1, 0}), hunt_lab_from_rgb({0, 0, 1})), ColorExponent);
    const double x = std::pow(difference, ColorExponent), knee = LargeError * Largest;
    if (x < knee) return x * LargeErrorMap / knee;
    return std::min(1.0, LargeErrorMap + (x - knee) / (Largest - knee) * (1.0 - LargeErrorMap));
}

RgbPlanes opponents(const RgbPlanes& rgb) {
    RgbPlanes planes = rgb;
    tbb::parallel_for(std::size_t{0}, rgb[0].values.size(), [&](std::size_t i) {
        const glm::dvec3 o = opponent_from_rgb({rgb[0].values[i], rgb[1].values[i], rgb[2].values[i]});
        for (int c = 0; c < 3; ++c) planes[static_cast<std::size_t>(c)].values[i] = static_cast<float>(o[c]);
    });
    return planes;
}

// A Gaussian is separable, the sum of two is not: each is filtered alone, weighted by its part of the sum.
Plane filtered(const Plane& plane, const Sensitivity& sensitivity) {
    const int radius =
        static_cast<int>(std::ceil(3.0 * std::sqrt(WidestTerm / (2.0 * pi * pi)) * PixelsPerDegree));
    const auto sigma = [](double b) { return std::sqrt(b / 2.0) / pi * PixelsPerDegree; };
    const auto weight = [&](double a, double b) {
        double sum = 0.0;
        for (int x = -radius; x <= radius; ++x) sum += std::exp(-x * x / (2.0 * sigma(b) * sigma(b)));
        return a * std::sqrt(pi / b) * sum * sum;
    };
    const auto term = [&](double b) {
        const Kernel kernel = gaussian(sigma(b), radius);
        return convolve(plane, kernel, kernel);
    };
    Plane result = term(sensitivity.b1);
    if (sensitivity.a2 == 0.0) return result;
    const double first = weight(sensitivity.a1, sensitivity.b1),
                 second = weight(sensitivity.a2, sensitivity.b2);
    const float second_weight = static_cast<float>(second / (first + second));
    const Plane other = term(sensitivity.b2);
    for (std::size_t i = 0; i < result.values.size(); ++i)
        result.values[i] += second_weight * (other.values[i] - result.values[i]);
    return result;
}

RgbPlanes seen(const RgbPlanes& opponent) {
    return {filtered(opponent[0], Achromatic), filtered(opponent[1], RedGreen),
            filtered(opponent[2], BlueYellow)};
}

Plane grey(const Plane& y) {
    Plane plane = y;
    for (float& value : plane.values) value = (value + 16.0f) / 116.0f;
    return plane;
}

glm::dvec3 perceived(const RgbPlanes& seen_planes, std::size_t i) {
    const glm::dvec3 opponent(seen_planes[0].values[i], seen_planes[1].values[i], seen_planes[2].values[i]);
    return hunt_lab_from_rgb(glm::clamp(rgb_from_opponent(opponent), 0.0, 1.0));
}

}  // namespace

Plane flip_map(const RgbPlanes& picture, const RgbPlanes& reference) {
    const RgbPlanes opponent = opponents(picture), reference_opponent = opponents(reference);
    const Plane features =
        flip_feature_difference(grey(opponent[0]), grey(reference_opponent[0]), PixelsPerDegree);
    const RgbPlanes a = seen(opponent), b = seen(reference_opponent);
    Plane map(picture[0].width, picture[0].height);
    tbb::parallel_for(std::size_t{0}, map.values.size(), [&](std::size_t i) {
        const double color = redistributed(hyab(perceived(a, i), perceived(b, i)));
        map.values[i] = static_cast<float>(std::pow(color, 1.0 - features.values[i]));
    });
    return map;
}

}  // namespace tessera::picture

#include "mediator/picture/flip_features.h"

#include <algorithm>
#include <cmath>

namespace tessera::picture {

namespace {

constexpr double FeatureWidth = 0.082;   // w, degrees: peak to trough of an edge detector of human vision
constexpr double FeatureExponent = 0.5;  // q_f

// Positive weights sum to 1 and negative ones to -1, so that the response to a full step is 1.
Kernel balanced(Kernel kernel) {
    double positive = 0.0, negative = 0.0;
    for (const float weight : kernel) (weight > 0.0f ? positive : negative) += weight;
    for (float& weight : kernel) weight = static_cast<float>(weight / (weight > 0.0f ? positive : -negative));
    return kernel;
}

struct Detectors {
    Kernel smooth, edge, point;  // Gaussian and its first and second derivative
};
Detectors detectors(double pixels_per_degree) {
    const double sigma = 0.5 * FeatureWidth * pixels_per_degree;
    const int radius = static_cast<int>(std::ceil(3.0 * sigma));
    Detectors result{gaussian(sigma, radius), {}, {}};
    for (int x = -radius; x <= radius; ++x) {
        const double g = std::exp(-x * x / (2.0 * sigma * sigma));
        result.edge.push_back(static_cast<float>(-x * g));
        result.point.push_back(static_cast<float>((x * x / (sigma * sigma) - 1.0) * g));
    }
    result.edge = balanced(result.edge);
    result.point = balanced(result.point);
    return result;
}

// The length of the response across and down.
Plane strength(const Plane& plane, const Kernel& smooth, const Kernel& detector) {
    Plane across = convolve(plane, detector, smooth);
    const Plane down = convolve(plane, smooth, detector);
    for (std::size_t i = 0; i < across.values.size(); ++i)
        across.values[i] = std::hypot(across.values[i], down.values[i]);
    return across;
}

}  // namespace

Plane flip_feature_difference(const Plane& picture, const Plane& reference, double pixels_per_degree) {
    const Detectors d = detectors(pixels_per_degree);
    const Plane edges = strength(picture, d.smooth, d.edge), points = strength(picture, d.smooth, d.point);
    const Plane reference_edges = strength(reference, d.smooth, d.edge);
    const Plane reference_points = strength(reference, d.smooth, d.point);
    Plane difference(picture.width, picture.height);
    for (std::size_t i = 0; i < difference.values.size(); ++i) {
        const double edge = std::abs(edges.values[i] - reference_edges.values[i]);
        const double point = std::abs(points.values[i] - reference_points.values[i]);
        difference.values[i] = static_cast<float>(
            std::min(1.0, std::pow(std::max(edge, point) / std::sqrt(2.0), FeatureExponent)));
    }
    return difference;
}

}  // namespace tessera::picture

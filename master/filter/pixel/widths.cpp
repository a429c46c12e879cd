#include "master/filter/pixel/widths.h"

#include <vector>

namespace tessera::filter::pixel {

namespace {

std::vector<double> sampled_gaussian(double sigma) {
    const auto radius = static_cast<int>(3.0 * sigma);
    std::vector<double> kernel;
    double sum = 0.0;
    for (int i = -radius; i <= radius; ++i) {
        kernel.push_back(std::exp(-0.5 * i * i / (sigma * sigma)));
        sum += kernel.back();
    }
    for (double& weight : kernel) weight /= sum;
    return kernel;
}

double squares(const std::vector<double>& kernel) {
    double sum = 0.0;
    for (const double weight : kernel) sum += weight * weight;
    return sum;
}

}  // namespace

double reduction_ratio(double sigma, int iterations) {
    std::vector<double> joint{1.0};
    for (int k = 1; k <= iterations; ++k) {
        const std::vector<double> kernel = sampled_gaussian(iteration_sigma(sigma, k, iterations));
        std::vector<double> wider(joint.size() + kernel.size() - 1, 0.0);
        for (std::size_t i = 0; i < joint.size(); ++i) {
            for (std::size_t j = 0; j < kernel.size(); ++j) wider[i + j] += joint[i] * kernel[j];
        }
        joint = std::move(wider);
    }
    const double first = squares(sampled_gaussian(iteration_sigma(sigma, 1, iterations)));
    const double ratio = squares(joint) / first;  // in one dimension
    return ratio * ratio;
}

}  // namespace tessera::filter::pixel

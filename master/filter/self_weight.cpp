#include "master/filter/self_weight.h"

#include <algorithm>
#include <cmath>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

constexpr std::size_t PoolRadius = 5;  // that of the convergence blend
constexpr float Most = 1e15f;          // so that sums of squares stay finite

float self_weight_floor(const Planes& filtered) {
    double sum = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (const float v : filtered.plane(c)) sum += std::abs(v);
    }
    const double floor = 0.1 * sum / static_cast<double>(filtered.pixel_count());
    return static_cast<float>(std::clamp(floor, 1e-30, 1e37));
}

}  // namespace

bool SelfWeight::run(const Inputs& inputs, std::span<const float> change, std::span<const float> scale,
                     std::span<const float> response, const Planes& filtered, RunContext& context) {
    shape(sums_, inputs, 4);
    shape(weights_, inputs, 1);
    const std::size_t width = inputs.width, height = inputs.height;
    const float floor = self_weight_floor(filtered);
    return for_rows(context, inputs.height,
                    [&](std::uint32_t y) {
                        float *covariance = sums_.row(0, y), *variance = sums_.row(1, y);
                        for (std::size_t x = 0; x < width; ++x) {
                            const std::size_t i = std::size_t{y} * width + x;
                            float brightness = floor;
                            for (std::uint32_t c = 0; c < 3; ++c)
                                brightness += std::abs(filtered.row(c, y)[x]);
                            brightness = std::min(brightness, 1e38f);
                            const float factor = scale.empty() ? 1.0f : scale[i];
                            const float u = std::clamp(factor * (change[i] / brightness), -Most, Most);
                            const float f = std::clamp(response[i] / brightness, -Most, Most);
                            covariance[x] = u * f;
                            variance[x] = u * u;
                        }
                        for (std::uint32_t term = 0; term < 2; ++term) {
                            const float* from = sums_.row(term, y);
                            float* to = sums_.row(2 + term, y);
                            for (std::size_t x = 0; x < width; ++x) {
                                const std::size_t first = x > PoolRadius ? x - PoolRadius : 0;
                                const std::size_t last = std::min(width, x + PoolRadius + 1);
                                float sum = 0.0f;
                                for (std::size_t i = first; i < last; ++i) sum += from[i];
                                to[x] = sum;
                            }
                        }
                    }) &&
           for_rows(context, inputs.height, [&](std::uint32_t y) {
               const std::size_t first = y > PoolRadius ? y - PoolRadius : 0;
               const std::size_t last = std::min(height, y + PoolRadius + 1);
               float *weights = weights_.row(0, y), *variance = sums_.row(0, y);  // no longer needed
               std::fill_n(weights, width, 0.0f);
               std::fill_n(variance, width, 1e-37f);
               for (std::size_t i = first; i < last; ++i) {
                   const float* covariances = sums_.row(2, static_cast<std::uint32_t>(i));
                   const float* variances = sums_.row(3, static_cast<std::uint32_t>(i));
                   for (std::size_t x = 0; x < width; ++x) {
                       weights[x] += covariances[x];
                       variance[x] += variances[x];
                   }
               }
               for (std::size_t x = 0; x < width; ++x)
                   weights[x] = std::clamp(weights[x] / variance[x], 0.0f, 1.0f);
           });
}

}  // namespace tessera::filter

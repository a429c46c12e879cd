#include "master/filter/nfor/self_weight.h"

#include <algorithm>
#include <cmath>

#include "master/filter/kernels.h"

namespace tessera::filter::nfor {

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

bool SelfWeight::run(const Inputs& inputs, const std::array<Planes, 2>& colors, const Planes& scale,
                     std::span<const float> change, const Planes& filtered, RunContext& context) {
    shape(sums_, inputs, 4);
    shape(weights_, inputs, 1);
    const std::size_t width = inputs.width, height = inputs.height;
    const float floor = self_weight_floor(filtered);
    return for_rows(context, inputs.height,
                    [&](std::uint32_t y) {
                        float *covariance = sums_.row(0, y), *variance = sums_.row(1, y);
                        for (std::size_t x = 0; x < width; ++x) {
                            float difference = 0.0f, brightness = floor;
                            for (std::uint32_t c = 0; c < 3; ++c) {
                                difference += colors[0].row(c, y)[x] - colors[1].row(c, y)[x];
                                brightness += std::abs(filtered.row(c, y)[x]);
                            }
                            brightness = std::min(brightness, 1e38f);
                            const float u =
                                std::clamp(scale.row(0, y)[x] * (difference / brightness), -Most, Most);
                            const float f =
                                std::clamp(change[std::size_t{y} * width + x] / brightness, -Most, Most);
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

}  // namespace tessera::filter::nfor

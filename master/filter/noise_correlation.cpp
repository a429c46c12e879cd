#include "master/filter/noise_correlation.h"

#include <algorithm>
#include <array>

namespace tessera::filter {

namespace {

constexpr std::int64_t Stretch = 256;  // of a row: its sums stay in the first cache

void put_light(const Planes& mean, std::uint32_t y, float* to) {
    const float *r = mean.row(0, y), *g = mean.row(1, y), *b = mean.row(2, y);
    for (std::uint32_t x = 0; x < mean.width(); ++x) to[x] = luminance(r[x], g[x], b[x]);
}

// Four times the difference between a pixel and its neighbours that are no holes.
void put_residual(const Inputs& inputs, const Planes& light, std::uint32_t which, std::uint32_t y,
                  float* to) {
    const std::uint32_t width = inputs.width;
    const std::uint32_t above = y == 0 ? y : y - 1, below = y + 1 == inputs.height ? y : y + 1;
    const float* own = light.row(which, y);
    const auto difference = [&](std::uint32_t row, std::uint32_t x, float from) {
        return inputs.counts.row(0, row)[x] > 0.0f ? light.row(which, row)[x] - from : 0.0f;
    };
    for (std::uint32_t x = 0; x < width; ++x) {
        const std::uint32_t left = x == 0 ? x : x - 1, right = x + 1 == width ? x : x + 1;
        const float sum = difference(y, left, own[x]) + difference(y, right, own[x]) +
                          difference(above, x, own[x]) + difference(below, x, own[x]);
        to[x] = inputs.counts.row(0, y)[x] > 0.0f ? sum : 0.0f;
    }
}

void put_squared(const Planes& residual, std::int64_t radius, std::uint32_t y, float* to) {
    const std::int64_t width = residual.width(), height = residual.height();
    for (std::int64_t begin = 0; begin < width; begin += Stretch) {
        const std::int64_t end = std::min(begin + Stretch, width);
        std::array<std::array<float, Stretch>, 3> sums{};  // both squares, the product
        for (std::int64_t row = std::max<std::int64_t>(y - radius, 0); row < std::min(y + radius + 1, height);
             ++row) {
            const float* a = residual.row(0, static_cast<std::uint32_t>(row));
            const float* b = residual.row(1, static_cast<std::uint32_t>(row));
            for (std::int64_t dx = -radius; dx <= radius; ++dx) {
                const std::int64_t first = std::max(begin, -dx), last = std::min(end, width - dx);
                for (std::int64_t x = first; x < last; ++x) {
                    const auto at = static_cast<std::size_t>(x - begin);
                    sums[0][at] += a[x + dx] * a[x + dx];
                    sums[1][at] += b[x + dx] * b[x + dx];
                    sums[2][at] += a[x + dx] * b[x + dx];
                }
            }
        }
        for (std::int64_t x = begin; x < end; ++x) {
            const auto at = static_cast<std::size_t>(x - begin);
            const float ratio = (sums[2][at] / sums[0][at]) * (sums[2][at] / sums[1][at]);
            to[x] = ratio < 1.0f ? ratio : 1.0f;  // also if it is not a number
        }
    }
}

}  // namespace

bool NoiseCorrelation::run(const Inputs& inputs, frame::Channel a, frame::Channel b, std::uint32_t radius,
                           RunContext& context) {
    shape(light_, inputs, 2);
    shape(residual_, inputs, 2);
    shape(squared_, inputs, 1);
    const std::array channels{a, b};
    const auto for_both = [&](const auto& put) {
        return for_rows(context, inputs.height, [&](std::uint32_t y) {
            for (std::uint32_t which = 0; which < 2; ++which) put(which, y);
        });
    };
    return for_both([&](std::uint32_t which, std::uint32_t y) {
               put_light(inputs.mean(channels[which]), y, light_.row(which, y));
           }) &&
           for_both([&](std::uint32_t which, std::uint32_t y) {
               put_residual(inputs, light_, which, y, residual_.row(which, y));
           }) &&
           for_rows(context, inputs.height,
                    [&](std::uint32_t y) { put_squared(residual_, radius, y, squared_.row(0, y)); });
}

}  // namespace tessera::filter

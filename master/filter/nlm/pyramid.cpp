#include "master/filter/nlm/pyramid.h"

#include <algorithm>
#include <array>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

constexpr std::int64_t HalfTaps = 3;  // taps on each side of the centre

std::array<float, 2 * HalfTaps> gauss_weights() {
    constexpr double Sigma = 0.55 * 1.7320508075688772;
    std::array<double, 2 * HalfTaps> exact;
    double sum = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const double t = (static_cast<double>(i) - 2.5) / Sigma;
        exact[i] = std::exp(-0.5 * t * t);
        sum += exact[i];
    }
    std::array<float, 2 * HalfTaps> weights;
    for (std::size_t i = 0; i < exact.size(); ++i) weights[i] = static_cast<float>(exact[i] / sum);
    return weights;
}

void halve_with(const std::array<float, 2 * HalfTaps>& weights, const Planes& in, Planes& out,
                RunContext& context) {
    const std::int64_t width = in.width(), height = in.height();
    const std::uint32_t half_width = (in.width() + 1) / 2, half_height = (in.height() + 1) / 2;
    if (out.width() != half_width || out.height() != half_height || out.components() != in.components()) {
        out = Planes(half_width, half_height, in.components());
    }
    for_rows(context, half_height, [&](std::uint32_t y) {
        for (std::uint32_t c = 0; c < in.components(); ++c) {
            std::array<const float*, 2 * HalfTaps> rows;
            for (std::int64_t i = 0; i < 2 * HalfTaps; ++i) {
                const std::int64_t row = std::clamp<std::int64_t>(2 * std::int64_t{y} + i - 2, 0, height - 1);
                rows[static_cast<std::size_t>(i)] = in.row(c, static_cast<std::uint32_t>(row));
            }
            // Down the columns first, for a stretch of the row and its margins.
            constexpr std::int64_t Stretch = 128;
            std::array<float, 2 * Stretch + 2 * (HalfTaps - 1)> columns;
            for (std::int64_t first = 0; first < half_width; first += Stretch) {
                const std::int64_t count = std::min(Stretch, half_width - first), left = 2 * first - 2,
                                   from = std::max<std::int64_t>(left, 0),
                                   to = std::min(left + 2 * count + 4, width);
                const auto at = [&](std::int64_t x) -> float& {
                    return columns[static_cast<std::size_t>(x - left)];
                };
                for (std::int64_t x = from; x < to; ++x) {
                    float sum = 0.0f;
                    for (std::size_t i = 0; i < rows.size(); ++i) sum += weights[i] * rows[i][x];
                    at(x) = sum;
                }
                for (std::int64_t x = left; x < from; ++x) at(x) = at(from);
                for (std::int64_t x = to; x < left + 2 * count + 4; ++x) at(x) = at(to - 1);
                float* halved = out.row(c, y) + first;
                for (std::int64_t x = 0; x < count; ++x) {
                    float sum = 0.0f;
                    for (std::size_t j = 0; j < weights.size(); ++j) {
                        sum += weights[j] * columns[static_cast<std::size_t>(2 * x) + j];
                    }
                    halved[x] = sum;
                }
            }
        }
    });
}

}  // namespace

void halve(const Planes& in, Planes& out, RunContext& context) {
    halve_with(gauss_weights(), in, out, context);
}

void halve_variance(const Planes& in, Planes& out, RunContext& context) {
    std::array<float, 2 * HalfTaps> weights = gauss_weights();
    for (float& weight : weights) weight *= weight;
    halve_with(weights, in, out, context);
}

void add_difference(const Planes& from, const Planes& halved, Planes& to, RunContext& context) {
    const std::int64_t half_width = from.width(), half_height = from.height();
    for_rows(context, to.height(), [&](std::uint32_t y) {
        // An even row is a quarter above the centre of its pair, an odd one a quarter below.
        const std::int64_t near = y / 2, far = std::clamp<std::int64_t>(y % 2 == 0 ? near - 1 : near + 1, 0,
                                                                        half_height - 1);
        for (std::uint32_t c = 0; c < to.components(); ++c) {
            const float* near_from = from.row(c, static_cast<std::uint32_t>(near));
            const float* far_from = from.row(c, static_cast<std::uint32_t>(far));
            const float* near_halved = halved.row(c, static_cast<std::uint32_t>(near));
            const float* far_halved = halved.row(c, static_cast<std::uint32_t>(far));
            const auto difference = [&](std::int64_t x) {
                return 0.75f * (near_from[x] - near_halved[x]) + 0.25f * (far_from[x] - far_halved[x]);
            };
            float* row = to.row(c, y);
            for (std::int64_t x = 0; x < std::int64_t{to.width()}; ++x) {
                const std::int64_t neighbour =
                    std::clamp<std::int64_t>(x % 2 == 0 ? x / 2 - 1 : x / 2 + 1, 0, half_width - 1);
                row[x] += 0.75f * difference(x / 2) + 0.25f * difference(neighbour);
            }
        }
    });
}

}  // namespace tessera::filter

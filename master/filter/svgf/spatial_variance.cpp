#include "master/filter/svgf/spatial_variance.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

enum Sum : std::uint32_t { Known, Square, Weight, RowKnown, RowMean, RowSquare, SumCount };

// Deviation, relative to the light: below it are differences of rounding, not of samples.
constexpr float Rounding = 0x1p-21f;
constexpr std::int64_t Radius = 3;
// exp(-d^2 / (2 * 1.5^2))
constexpr std::array<float, 4> Gaussian{1.0f, 0.80073740f, 0.41111229f, 0.13533528f};

// One row of surfaces.
struct Surfaces {
    const float *nx, *ny, *nz, *inverse_depth;
    const std::uint32_t* ids;
};

Surfaces surfaces_of(const Guides& guides, std::uint32_t y, std::int64_t x) {
    return {guides.normal.row(0, y) + x, guides.normal.row(1, y) + x, guides.normal.row(2, y) + x,
            guides.inverse_depth.row(0, y) + x,
            guides.ids.data() + static_cast<std::int64_t>(y) * guides.inverse_depth.width() + x};
}

// Weights of `there` relative to `here`, both starting at the pixel of `slope`; geometry only, without
// luminance.
void surface_weights(const Surfaces& here, const Surfaces& there, const float* slope, float distance,
                     float kernel, const EdgeStops& stops, std::size_t count, float* __restrict weights) {
    const EdgeStops s = stops;
    for (std::size_t x = 0; x < count; ++x) {
        const float dot = here.nx[x] * there.nx[x] + here.ny[x] * there.ny[x] + here.nz[x] * there.nz[x];
        const float depth = std::fabs(here.inverse_depth[x] - there.inverse_depth[x]) *
                            depth_scale(here.inverse_depth[x], distance * slope[x], s);
        const float w = kernel * exp_negative(-(normal_distance(dot, s.sigma_n) + depth));
        weights[x] = (here.ids[x] == there.ids[x]) & (dot > 0.0f) ? w : 0.0f;
    }
}

// `to` += weights * values.
void add_weighted(const float* weights, const float* w, const float* first, const float* second,
                  std::size_t count, float* __restrict to_w, float* __restrict to_first,
                  float* __restrict to_second) {
    for (std::size_t x = 0; x < count; ++x) {
        to_w[x] += weights[x] * w[x];
        to_first[x] += weights[x] * first[x];
        to_second[x] += weights[x] * second[x];
    }
}

}  // namespace

bool SpatialVariance::run(const Guides& guides, const EdgeStops& stops, float young, bool blurs, State& state,
                          RunContext& context) {
    const std::uint32_t width = state.moments.width(), height = state.moments.height();
    if (raw_.width() != width || raw_.height() != height) {
        raw_ = Planes(width, height, 1);
        young_rows_.assign(height, 0);
    }
    const bool of_mean = stops.deviation == Deviation::Mean;
    if (!for_rows(context, height, [&](std::uint32_t y) {
            const float* mean = state.moments.row(MeanLuminance, y);
            const float* variance = state.moments.row(SampleVariance, y);
            const float* age = state.moments.row(Age, y);
            float* __restrict raw = raw_.row(0, y);
            std::uint32_t found = 0;
            for (std::uint32_t x = 0; x < width; ++x) {
                const float unbiased = variance[x] / std::max(age[x] - 1.0f, 0.5f);
                const float rounding = Rounding * mean[x];
                raw[x] = std::max(of_mean ? unbiased : unbiased * age[x], rounding * rounding);
                found |= age[x] < young ? 1u : 0u;
            }
            young_rows_[y] = static_cast<std::uint8_t>(found);
        })) {
        return false;
    }
    const bool any = std::find(young_rows_.begin(), young_rows_.end(), 1) != young_rows_.end();
    if (any && !estimate(guides, stops, young, state, context)) return false;
    return for_rows(context, height, [&](std::uint32_t y) {
        const float* here = raw_.row(0, y);
        const float* above = raw_.row(0, y > 0 ? y - 1 : y);
        const float* below = raw_.row(0, y + 1 < height ? y + 1 : y);
        float* __restrict out = state.color.row(3, y);
        if (!blurs) {
            std::copy_n(here, width, out);
            return;
        }
        const auto column = [&](std::size_t x) {
            return 0.25f * above[x] + 0.5f * here[x] + 0.25f * below[x];
        };
        for (std::uint32_t x = 1; x + 1 < width; ++x) {
            out[x] = 0.25f * column(x - 1) + 0.5f * column(x) + 0.25f * column(x + 1);
        }
        const std::uint32_t last = width - 1;
        out[0] = 0.75f * column(0) + 0.25f * column(std::min(1u, last));
        out[last] = 0.75f * column(last) + 0.25f * column(last > 0 ? last - 1 : 0);
    });
}

bool SpatialVariance::estimate(const Guides& guides, const EdgeStops& stops, float young, const State& state,
                               RunContext& context) {
    const std::uint32_t width = state.moments.width(), height = state.moments.height();
    if (sums_.width() != width || sums_.height() != height) sums_ = Planes(width, height, SumCount);
    const auto near_young = [&](std::uint32_t y) {
        const std::uint32_t first = y > Radius ? y - Radius : 0;
        const std::uint32_t last = std::min<std::uint32_t>(height - 1, y + Radius);
        return std::find(young_rows_.begin() + first, young_rows_.begin() + last + 1, 1) !=
               young_rows_.begin() + last + 1;
    };
    return for_rows(context, height,
                    [&](std::uint32_t y) {
                        if (near_young(y)) sum_along(guides, stops, state, y);
                    }) &&
           for_rows(context, height, [&](std::uint32_t y) {
               if (young_rows_[y]) sum_across(guides, stops, young, state, y);
           });
}

void SpatialVariance::sum_along(const Guides& guides, const EdgeStops& stops, const State& state,
                                std::uint32_t y) {
    const std::uint32_t width = state.moments.width();
    const float* mean = state.moments.row(MeanLuminance, y);
    const float* variance = state.moments.row(SampleVariance, y);
    const float* age = state.moments.row(Age, y);
    float* __restrict known = sums_.row(Known, y);
    float* __restrict square = sums_.row(Square, y);
    float* __restrict sum_known = sums_.row(RowKnown, y);
    float* __restrict sum_mean = sums_.row(RowMean, y);
    float* __restrict sum_square = sums_.row(RowSquare, y);
    for (std::uint32_t x = 0; x < width; ++x) {
        known[x] = age[x] > 0.0f ? 1.0f : 0.0f;
        square[x] = variance[x] + mean[x] * mean[x];
        sum_known[x] = known[x];
        sum_mean[x] = known[x] * mean[x];
        sum_square[x] = known[x] * square[x];
    }
    for (std::int64_t d = -Radius; d <= Radius; ++d) {
        const std::int64_t begin = std::max<std::int64_t>(0, -d);
        const std::int64_t end = std::min<std::int64_t>(width, std::int64_t{width} - d);
        if (d == 0 || begin >= end) continue;
        const auto count = static_cast<std::size_t>(end - begin);
        float* weights = sums_.row(Weight, y);
        surface_weights(surfaces_of(guides, y, begin), surfaces_of(guides, y, begin + d),
                        guides.slope.row(0, y) + begin, static_cast<float>(std::abs(d)),
                        Gaussian[static_cast<std::size_t>(std::abs(d))], stops, count, weights);
        for (std::size_t i = 0; i < count; ++i) weights[i] *= known[begin + d + static_cast<std::int64_t>(i)];
        add_weighted(weights, known + begin + d, mean + begin + d, square + begin + d, count,
                     sum_known + begin, sum_mean + begin, sum_square + begin);
    }
}

void SpatialVariance::sum_across(const Guides& guides, const EdgeStops& stops, float young,
                                 const State& state, std::uint32_t y) {
    constexpr std::uint32_t Chunk = 256;
    const std::uint32_t width = state.moments.width(), height = state.moments.height();
    const bool of_mean = stops.deviation == Deviation::Mean;
    const float* age = state.moments.row(Age, y);
    float* __restrict raw = raw_.row(0, y);
    for (std::uint32_t start = 0; start < width; start += Chunk) {
        const std::uint32_t count = std::min(Chunk, width - start);
        std::array<float, Chunk> weights, known{}, mean{}, square{};
        for (std::int64_t d = -Radius; d <= Radius; ++d) {
            const std::int64_t other = std::int64_t{y} + d;
            if (other < 0 || other >= height) continue;
            const auto ty = static_cast<std::uint32_t>(other);
            if (d == 0) {
                weights.fill(1.0f);
            } else {
                surface_weights(surfaces_of(guides, y, start), surfaces_of(guides, ty, start),
                                guides.slope.row(1, y) + start, static_cast<float>(std::abs(d)),
                                Gaussian[static_cast<std::size_t>(std::abs(d))], stops, count,
                                weights.data());
            }
            add_weighted(weights.data(), sums_.row(RowKnown, ty) + start, sums_.row(RowMean, ty) + start,
                         sums_.row(RowSquare, ty) + start, count, known.data(), mean.data(), square.data());
        }
        for (std::uint32_t k = 0; k < count; ++k) {
            const std::size_t x = start + k;
            const float scale = 1.0f / std::max(known[k], Tiny);
            const float m1 = mean[k] * scale;
            const float variance = std::max(0.0f, square[k] * scale - m1 * m1);
            const float wide = of_mean ? variance / std::max(age[x], 1.0f) : variance;
            raw[x] = age[x] < young ? wide : raw[x];
        }
    }
}

}  // namespace tessera::filter::svgf

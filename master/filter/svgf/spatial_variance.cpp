#include "master/filter/svgf/spatial_variance.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

constexpr std::int64_t Radius = 3;
// exp(-d^2 / (2 * 1.5^2))
constexpr std::array<float, 4> Gaussian{1.0f, 0.80073740f, 0.41111229f, 0.13533528f};

// The weight of one surface seen from another pixel of it, without the light.
float surface_weight(const float* const* a, const float* const* b, std::size_t i, std::size_t j,
                     float inverse_depth_change, const EdgeStops& stops, bool same_id) {
    const float dot = a[0][i] * b[0][j] + a[1][i] * b[1][j] + a[2][i] * b[2][j];
    const float depth =
        std::fabs(a[3][i] - b[3][j]) * depth_scale(std::min(a[3][i], b[3][j]), inverse_depth_change, stops);
    const float w = exp_negative(-(normal_distance(dot, stops.sigma_n) + depth));
    return same_id & (dot > 0.0f) ? w : 0.0f;
}

std::array<const float*, 4> surface_rows(const Guides& guides, std::uint32_t y) {
    return {guides.normal.row(0, y), guides.normal.row(1, y), guides.normal.row(2, y),
            guides.inverse_depth.row(0, y)};
}

}  // namespace

bool SpatialVariance::run(const Guides& guides, const EdgeStops& stops, float young, State& state,
                          RunContext& context) {
    const std::uint32_t width = state.moments.width(), height = state.moments.height();
    if (raw_.width() != width || raw_.height() != height) {
        raw_ = Planes(width, height, 1);
        young_rows_.assign(height, 0);
    }
    const bool of_mean = stops.deviation == Deviation::Mean;
    if (!for_rows(context, height, [&](std::uint32_t y) {
            const float* variance = state.moments.row(SampleVariance, y);
            const float* age = state.moments.row(Age, y);
            float* __restrict raw = raw_.row(0, y);
            std::uint32_t found = 0;
            for (std::uint32_t x = 0; x < width; ++x) {
                const float unbiased = variance[x] / std::max(age[x] - 1.0f, 0.5f);
                raw[x] = of_mean ? unbiased : unbiased * age[x];
                found |= age[x] < young ? 1u : 0u;
            }
            young_rows_[y] = static_cast<std::uint8_t>(found);
        })) {
        return false;
    }
    const auto rows = std::count(young_rows_.begin(), young_rows_.end(), 1);
    young_share_ = static_cast<double>(rows) / height;
    if (rows > 0 && !estimate(guides, stops, young, state, context)) return false;
    return for_rows(context, height, [&](std::uint32_t y) {
        const float* here = raw_.row(0, y);
        const float* above = raw_.row(0, y > 0 ? y - 1 : y);
        const float* below = raw_.row(0, y + 1 < height ? y + 1 : y);
        float* __restrict out = state.color.row(3, y);
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
    if (sums_.width() != width || sums_.height() != height) sums_ = Planes(width, height, 3);
    const auto near_young = [&](std::uint32_t y) {
        const std::uint32_t first = y > Radius ? y - Radius : 0;
        const std::uint32_t last = std::min<std::uint32_t>(height - 1, y + Radius);
        for (std::uint32_t row = first; row <= last; ++row) {
            if (young_rows_[row]) return true;
        }
        return false;
    };
    if (!for_rows(context, height, [&](std::uint32_t y) {
            if (!near_young(y)) return;
            const auto rows = surface_rows(guides, y);
            const float* slope = guides.slope.row(0, y);
            const std::uint32_t* ids = guides.ids.data() + std::size_t{y} * width;
            const float* mean = state.moments.row(MeanLuminance, y);
            const float* variance = state.moments.row(SampleVariance, y);
            const float* age = state.moments.row(Age, y);
            float* __restrict weights = sums_.row(0, y);
            float* __restrict first = sums_.row(1, y);
            float* __restrict second = sums_.row(2, y);
            std::fill(weights, weights + width, 0.0f);
            std::fill(first, first + width, 0.0f);
            std::fill(second, second + width, 0.0f);
            for (std::int64_t d = -Radius; d <= Radius; ++d) {
                const float g = Gaussian[static_cast<std::size_t>(std::abs(d))];
                const auto distance = static_cast<float>(std::abs(d));
                const std::int64_t begin = std::max<std::int64_t>(0, -d);
                const std::int64_t end = std::min<std::int64_t>(width, std::int64_t{width} - d);
                for (std::int64_t x = begin; x < end; ++x) {
                    const auto i = static_cast<std::size_t>(x), j = static_cast<std::size_t>(x + d);
                    const float same = surface_weight(rows.data(), rows.data(), i, j, distance * slope[i],
                                                      stops, ids[i] == ids[j]);
                    const float w = (d == 0 ? 1.0f : same) * g * (age[j] > 0.0f ? 1.0f : 0.0f);
                    weights[i] += w;
                    first[i] += w * mean[j];
                    second[i] += w * (variance[j] + mean[j] * mean[j]);
                }
            }
        })) {
        return false;
    }
    const bool of_mean = stops.deviation == Deviation::Mean;
    return for_rows(context, height, [&](std::uint32_t y) {
        if (!young_rows_[y]) return;
        constexpr std::uint32_t Chunk = 256;
        const auto here = surface_rows(guides, y);
        const float* slope = guides.slope.row(1, y);
        const float* age = state.moments.row(Age, y);
        float* __restrict raw = raw_.row(0, y);
        for (std::uint32_t start = 0; start < width; start += Chunk) {
            const std::uint32_t count = std::min(Chunk, width - start);
            std::array<float, Chunk> weights{}, first{}, second{};
            for (std::int64_t d = -Radius; d <= Radius; ++d) {
                const std::int64_t other = std::int64_t{y} + d;
                if (other < 0 || other >= height) continue;
                const auto ty = static_cast<std::uint32_t>(other);
                const auto there = surface_rows(guides, ty);
                const std::uint32_t* ids = guides.ids.data() + std::size_t{y} * width;
                const std::uint32_t* other_ids = guides.ids.data() + std::size_t{ty} * width;
                const float g = Gaussian[static_cast<std::size_t>(std::abs(d))];
                const auto distance = static_cast<float>(std::abs(d));
                const float *w0 = sums_.row(0, ty), *s1 = sums_.row(1, ty), *s2 = sums_.row(2, ty);
                for (std::uint32_t k = 0; k < count; ++k) {
                    const std::size_t x = start + k;
                    const float same = surface_weight(here.data(), there.data(), x, x, distance * slope[x],
                                                      stops, ids[x] == other_ids[x]);
                    const float w = (d == 0 ? 1.0f : same) * g;
                    weights[k] += w * w0[x];
                    first[k] += w * s1[x];
                    second[k] += w * s2[x];
                }
            }
            for (std::uint32_t k = 0; k < count; ++k) {
                const std::size_t x = start + k;
                const float scale = 1.0f / std::max(weights[k], Tiny);
                const float m1 = first[k] * scale;
                const float variance = std::max(0.0f, second[k] * scale - m1 * m1);
                const float wide = of_mean ? variance / std::max(age[x], 1.0f) : variance;
                raw[x] = age[x] < young ? wide : raw[x];
            }
        }
    });
}

}  // namespace tessera::filter::svgf

#include "master/filter/convergence_blend.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

// The differences of the three components come first.
enum Term : std::uint32_t { Difference, Gain = 3, Distance, Spread, Amplitude, TermCount };

constexpr float Most = 1e15f;  // deviations, so that sums of squares stay finite

// The terms of one row; 0 where the variance is unknown, so that those pixels do not contribute.
void fill_terms(const Inputs& inputs, frame::Channel filtered_part, const Planes& filtered,
                std::span<const float> self_weight, float floor, std::uint32_t y, Planes& terms) {
    const std::uint32_t width = inputs.width;
    float *gain = terms.row(Gain, y), *distance = terms.row(Distance, y);
    std::fill(gain, gain + width, 0.0f);
    std::fill(distance, distance + width, 0.0f);
    const float* counts = inputs.counts.row(0, y);
    const Planes& mean = inputs.mean(frame::Channel::Radiance);
    const Planes& variance = inputs.variance(filtered_part);
    for (std::uint32_t c = 0; c < mean.components(); ++c) {
        const float* u = mean.row(c, y);
        const float* v = variance.row(c, y);
        const float* f = filtered.row(c, y);
        float* difference = terms.row(Difference + c, y);
        for (std::uint32_t x = 0; x < width; ++x) {
            const float known = counts[x] >= 2.0f ? 1.0f : 0.0f;
            const float scale = known / (std::abs(f[x]) + floor);
            const float d = std::clamp((f[x] - u[x]) * scale, -Most, Most);
            difference[x] = d;
            const float deviation = std::min(std::sqrt(v[x]) * scale, Most);
            gain[x] += deviation * deviation;
            distance[x] += d * d;
        }
    }
    if (!self_weight.empty()) {
        const float* a = self_weight.data() + std::size_t{y} * width;
        for (std::uint32_t x = 0; x < width; ++x) gain[x] *= 1.0f - a[x];
    }
    float* amplitude = terms.row(Amplitude, y);
    for (std::uint32_t x = 0; x < width; ++x) amplitude[x] = std::sqrt(gain[x]);
}

// Half of the squared difference to the right and lower neighbours. At the border, and where the neighbour's
// variance is unknown, the pixel's own square is used instead.
void fill_spread(const Planes& counts, std::span<const float> self_weight, std::uint32_t y, Planes& terms) {
    const std::uint32_t width = terms.width();
    const bool last_row = y + 1 == terms.height();
    float* spread = terms.row(Spread, y);
    std::fill(spread, spread + width, 0.0f);
    for (std::uint32_t c = 0; c < 3; ++c) {
        const float* here = terms.row(Difference + c, y);
        const float* below = last_row ? here : terms.row(Difference + c, y + 1);
        const float* n = counts.row(0, y);
        const float* n_below = last_row ? n : counts.row(0, y + 1);
        for (std::uint32_t x = 0; x < width; ++x) {
            const float own = here[x] * here[x];
            const float down = here[x] - below[x];
            const bool has_down = !last_row && n_below[x] >= 2.0f;
            spread[x] += 0.5f * (n[x] < 2.0f ? 0.0f : has_down ? 0.5f * down * down : own);
        }
        for (std::uint32_t x = 0; x < width; ++x) {
            const bool has_right = x + 1 < width && n[x + 1] >= 2.0f;
            const float across = has_right ? here[x] - here[x + 1] : 0.0f;
            spread[x] += 0.5f * (n[x] < 2.0f ? 0.0f : has_right ? 0.5f * across * across : here[x] * here[x]);
        }
    }
    if (self_weight.empty()) return;
    // The noise of F - U is that of U times 1 - a, and the numerator has V (1 - a), not V (1 - a)^2.
    const float* a = self_weight.data() + std::size_t{y} * width;
    for (std::uint32_t x = 0; x < width; ++x) spread[x] /= std::max(1.0f - a[x], 1e-3f);
}

// A tenth of the mean absolute value, which is the floor of relMSE's denominator too.
float floor_of(const Planes& filtered, std::vector<double>& rows, RunContext& context) {
    rows.assign(filtered.height(), 0.0);
    for_rows(context, filtered.height(), [&](std::uint32_t y) {
        double sum = 0.0;
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float* values = filtered.row(c, y);
            for (std::uint32_t x = 0; x < filtered.width(); ++x) sum += std::abs(values[x]);
        }
        rows[y] = sum;
    });
    double sum = 0.0;
    for (const double row : rows) sum += row;
    const double mean = sum / (3.0 * static_cast<double>(filtered.pixel_count()));
    return std::max(0.1f * static_cast<float>(mean), 1e-30f);
}

// Sums over the squares of one row, `width` numbers each; column sums have ConvergenceBlend::MaxRadius zeroed
// pixels on either side.
enum Sum : std::size_t { Gains, Distances, Spreads, Amplitudes, SumCount };
constexpr std::array<Term, SumCount> SummedTerms{Gain, Distance, Spread, Amplitude};

// Sums of the terms over the squares around the pixels of row y, clipped to the picture.
void sum_squares(const Planes& terms, std::uint32_t y, std::uint32_t radius, float* columns, float* sums) {
    const std::size_t width = terms.width();
    const std::uint32_t first = y > radius ? y - radius : 0;
    const std::uint32_t last = std::min(terms.height() - 1, y + radius);
    for (std::size_t k = 0; k < SumCount; ++k) {
        float* __restrict column = columns + ConvergenceBlend::MaxRadius;
        std::fill_n(columns, width + 2 * ConvergenceBlend::MaxRadius, 0.0f);
        for (std::uint32_t row = first; row <= last; ++row) {
            const float* values = terms.row(SummedTerms[k], row);
            for (std::size_t x = 0; x < width; ++x) column[x] += values[x];
        }
        float* __restrict sum = sums + k * width;
        std::fill_n(sum, width, 0.0f);
        const float* from = columns + (ConvergenceBlend::MaxRadius - radius);
        for (std::uint32_t dx = 0; dx <= 2 * radius; ++dx) {
            for (std::size_t x = 0; x < width; ++x) sum[x] += from[x + dx];
        }
    }
}

// margin x gain / distance, at most 1.
void divide(const float* sums, std::size_t width, float margin, float* __restrict weight) {
    const float *gain = sums + Gains * width, *distance = sums + Distances * width,
                *spread = sums + Spreads * width;
    for (std::size_t x = 0; x < width; ++x) {
        const float known = margin * std::min(gain[x], spread[x]);
        const float part = known / std::max(distance[x], 1e-37f);
        weight[x] = known >= distance[x] ? 1.0f : part;
    }
}

}  // namespace

bool ConvergenceBlend::weigh(const Inputs& inputs, frame::Channel filtered_part,
                             std::span<const float> self_weight, const Planes& filtered,
                             RunContext& context) {
    shape(terms_, inputs, TermCount);
    shape(weights_, inputs, 1);
    const std::size_t width = inputs.width;
    scratch_.reserve(context, (SumCount + 2) * width + 2 * MaxRadius);
    const float floor = floor_of(filtered, row_sums_, context);
    const float side = 2.0f * static_cast<float>(radius_) + 1.0f;
    const float area_ratio = 9.0f / (side * side);  // of the 3 x 3 square to the large one
    return for_rows(context, inputs.height,
                    [&](std::uint32_t y) {
                        fill_terms(inputs, filtered_part, filtered, self_weight, floor, y, terms_);
                    }) &&
           for_rows(context, inputs.height,
                    [&](std::uint32_t y) { fill_spread(inputs.counts, self_weight, y, terms_); }) &&
           for_rows(context, inputs.height, [&](std::uint32_t y) {
               float* sums = scratch_.local();
               float *near = sums + SumCount * width, *columns = near + width;
               const float* counts = inputs.counts.row(0, y);
               float* weight = weights_.row(0, y);
               sum_squares(terms_, y, 1, columns, sums);
               divide(sums, width, Margin, near);
               sum_squares(terms_, y, radius_, columns, sums);
               divide(sums, width, 1.0f, weight);
               const float *amplitudes = sums + Amplitudes * width, *gains = sums + Gains * width;
               for (std::size_t x = 0; x < width; ++x) {
                   const float seen = amplitudes[x] * amplitudes[x] / std::max(gains[x], 1e-37f);
                   const float expected = area_ratio * seen;
                   const float blind = exp_negative(-expected) * (1.0f + expected * (1.0f + 0.5f * expected));
                   const float least = std::min(weight[x], near[x]);
                   const float w = least + blind * (weight[x] - least);
                   weight[x] = counts[x] < 2.0f ? 1.0f : w;
               }
           });
}

bool ConvergenceBlend::apply(const Inputs& inputs, frame::Channel filtered_part,
                             std::span<const float> self_weight, Planes& picture, RunContext& context) {
    if (!weigh(inputs, filtered_part, self_weight, picture, context)) return false;
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        const float* w = weights_.row(0, y);
        for (std::uint32_t c = 0; c < picture.components(); ++c) {
            const float* u = inputs.color(c).data() + std::size_t{y} * inputs.width;
            float* f = picture.row(c, y);
            for (std::uint32_t x = 0; x < inputs.width; ++x) f[x] = u[x] + w[x] * (f[x] - u[x]);
        }
    });
}

}  // namespace tessera::filter

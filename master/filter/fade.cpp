#include "master/filter/fade.h"

#include <algorithm>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

// The differences of the three components come first.
enum Term : std::uint32_t { Difference, Gain = 3, Distance, Spread, TermCount };

// The part of one row: 0 where the variance is unknown, so that those pixels have no say.
void fill_terms(const Inputs& inputs, frame::Channel channel, const Planes& filtered,
                std::span<const float> self_weight, float floor, std::uint32_t y, Planes& terms) {
    const std::uint32_t width = inputs.width;
    float *gain = terms.row(Gain, y), *distance = terms.row(Distance, y);
    std::fill(gain, gain + width, 0.0f);
    std::fill(distance, distance + width, 0.0f);
    const float* counts = inputs.counts.row(0, y);
    const Planes& mean = inputs.mean(channel);
    const Planes& variance = inputs.variance(channel);
    for (std::uint32_t c = 0; c < mean.components(); ++c) {
        const float* u = mean.row(c, y);
        const float* v = variance.row(c, y);
        const float* f = filtered.row(c, y);
        float* difference = terms.row(Difference + c, y);
        for (std::uint32_t x = 0; x < width; ++x) {
            const float known = counts[x] >= 2.0f ? 1.0f : 0.0f;
            const float scale = known / (std::abs(f[x]) + floor);
            const float d = (f[x] - u[x]) * scale;
            difference[x] = d;
            gain[x] += v[x] * scale * scale;
            distance[x] += d * d;
        }
    }
    if (self_weight.empty()) return;
    const float* a = self_weight.data() + std::size_t{y} * width;
    for (std::uint32_t x = 0; x < width; ++x) gain[x] *= 1.0f - a[x];
}

// Half of the squared difference of neighbours, to the right and below. Beyond a border, and to a pixel whose
// variance is unknown, the pixel's own square stands for it.
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

// to[x] = sum of from over the rows y - radius .. y + radius that there are.
void sum_column(const Planes& from, std::uint32_t component, std::uint32_t y, std::uint32_t radius,
                float* to) {
    const std::uint32_t first = y > radius ? y - radius : 0;
    const std::uint32_t last = std::min(from.height() - 1, y + radius);
    const std::uint32_t width = from.width();
    std::copy_n(from.row(component, first), width, to);
    for (std::uint32_t row = first + 1; row <= last; ++row) {
        const float* values = from.row(component, row);
        for (std::uint32_t x = 0; x < width; ++x) to[x] += values[x];
    }
}

}  // namespace

bool Fade::weigh(const Inputs& inputs, frame::Channel channel, const Planes& filtered,
                 std::span<const float> self_weight, RunContext& context) {
    shape(terms_, inputs, TermCount);
    shape(weights_, inputs, 1);
    columns_.reserve(context, 3 * std::size_t{inputs.width});
    const auto width = static_cast<std::int64_t>(inputs.width);
    const auto radius = static_cast<std::int64_t>(radius_);
    const float floor = floor_of(filtered, row_sums_, context);
    return for_rows(context, inputs.height,
                    [&](std::uint32_t y) {
                        fill_terms(inputs, channel, filtered, self_weight, floor, y, terms_);
                    }) &&
           for_rows(context, inputs.height,
                    [&](std::uint32_t y) { fill_spread(inputs.counts, self_weight, y, terms_); }) &&
           for_rows(context, inputs.height, [&](std::uint32_t y) {
               float* gain = columns_.local();
               float* distance = gain + width;
               float* spread = distance + width;
               sum_column(terms_, Gain, y, radius_, gain);
               sum_column(terms_, Distance, y, radius_, distance);
               sum_column(terms_, Spread, y, radius_, spread);
               const float* counts = inputs.counts.row(0, y);
               float* weight = weights_.row(0, y);
               for (std::int64_t x = 0; x < width; ++x) {
                   float g = 0.0f, d = 0.0f, s = 0.0f;
                   const std::int64_t first = std::max<std::int64_t>(0, x - radius);
                   const std::int64_t last = std::min(width - 1, x + radius);
                   for (std::int64_t i = first; i <= last; ++i) {
                       g += gain[i];
                       d += distance[i];
                       s += spread[i];
                   }
                   g = std::min(g, s);
                   weight[x] = counts[x] < 2.0f || g >= d ? 1.0f : g / d;
               }
           });
}

bool Fade::apply(const Inputs& inputs, std::span<const float> self_weight, Planes& picture,
                 RunContext& context) {
    if (!weigh(inputs, frame::Channel::Radiance, picture, self_weight, context)) return false;
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

#include "master/filter/nlm/color_nl_means.h"

#include <algorithm>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

// One pair beyond this makes the mean of a patch of up to 11 x 11 more than 87, where exp is 0.
constexpr float Most = 87.0f * 11.0f * 11.0f;

struct Span {
    std::int64_t first, last;
};

// Positions whose partner at this offset is also inside.
Span with_partner(std::int64_t size, std::int64_t offset) {
    return {std::max<std::int64_t>(0, -offset), std::min(size, size - offset)};
}

std::array<const float*, 4> rows_of(const Planes& match, std::int64_t y, std::int64_t x) {
    std::array<const float*, 4> rows;
    for (std::uint32_t c = 0; c < 4; ++c) rows[c] = match.row(c, static_cast<std::uint32_t>(y)) + x;
    return rows;
}

void compare(const std::array<const float*, 4>& a, const std::array<const float*, 4>& b, float k_squared,
             float epsilon, std::int64_t count, float* __restrict to) {
    const float *a0 = a[0], *a1 = a[1], *a2 = a[2], *va = a[3];
    const float *b0 = b[0], *b1 = b[1], *b2 = b[2], *vb = b[3];
    for (std::int64_t x = 0; x < count; ++x) {
        const float d0 = a0[x] - b0[x], d1 = a1[x] - b1[x], d2 = a2[x] - b2[x];
        const float square = d0 * d0 + d1 * d1 + d2 * d2;
        const float expected = va[x] + std::min(va[x], vb[x]);
        const float d = (square - expected) / (epsilon + k_squared * (va[x] + vb[x]));
        to[x] = std::min(d, Most);
    }
}

}  // namespace

bool ColorNlMeans::run(const Planes& match, const Planes& color, const Planes& known,
                       const ColorNlMeansSettings& settings, Planes& out, RunContext& context) {
    const std::uint32_t width = color.width(), height = color.height();
    const auto fit = [&](Planes& planes, std::uint32_t components) {
        if (planes.width() != width || planes.height() != height || planes.components() != components) {
            planes = Planes(width, height, components);
        }
    };
    fit(out, color.components());
    fit(weights_, 1);
    const std::uint32_t bands = (height + Band - 1) / Band;
    spaces_.resize(bands);
    return for_rows(context, bands, [&](std::uint32_t band) {
        const std::int64_t first = std::int64_t{band} * Band,
                           last = std::min<std::int64_t>(first + Band, height);
        Workspace& space = spaces_[band];
        const std::size_t row = width;
        space.pairs.resize(row * (2 * settings.patch + 1));
        space.columns.resize(row + 2 * settings.patch);
        space.weights.resize(row);
        space.inverse_counts.resize(row);
        for (std::int64_t y = first; y < last; ++y) {
            const auto at = static_cast<std::uint32_t>(y);
            for (std::uint32_t c = 0; c < out.components(); ++c) std::fill_n(out.row(c, at), width, 0.0f);
            std::fill_n(weights_.row(0, at), width, 0.0f);
        }
        const auto radius = static_cast<std::int64_t>(settings.radius);
        for (std::int64_t dy = -radius; dy <= radius; ++dy) {
            if (context.stop.stop_requested()) return;
            for (std::int64_t dx = -radius; dx <= radius; ++dx) {
                run_offset(match, color, known, settings, dx, dy, first, last, space, out);
            }
        }
        for (std::int64_t y = first; y < last; ++y) {
            const auto at = static_cast<std::uint32_t>(y);
            const float* weights = weights_.row(0, at);
            for (std::uint32_t c = 0; c < out.components(); ++c) {
                float* __restrict to = out.row(c, at);
                const float* own = color.row(c, at);
                for (std::uint32_t x = 0; x < width; ++x) {
                    to[x] = own[x] + (weights[x] > 1e-30f ? to[x] / weights[x] : 0.0f);
                }
            }
        }
    });
}

// Adds the pixels at offset (dx, dy) to rows [first, last) of `out`.
void ColorNlMeans::run_offset(const Planes& match, const Planes& color, const Planes& known,
                              const ColorNlMeansSettings& settings, std::int64_t dx, std::int64_t dy,
                              std::int64_t first, std::int64_t last, Workspace& space, Planes& out) {
    const std::int64_t width = color.width(), patch = settings.patch, rows = 2 * patch + 1;
    const Span across = with_partner(width, dx), down = with_partner(color.height(), dy);
    const std::int64_t count = across.last - across.first;
    first = std::max(first, down.first);
    last = std::min(last, down.last);
    if (count <= 0 || first >= last) return;

    float* __restrict inverse_counts = space.inverse_counts.data();
    for (std::int64_t x = 0; x < count; ++x) {
        inverse_counts[x] = 1.0f / static_cast<float>(std::min(x + patch, count - 1) -
                                                      std::max<std::int64_t>(x - patch, 0) + 1);
    }
    std::fill(space.columns.begin(), space.columns.end(), 0.0f);

    const auto pair_row = [&](std::int64_t y) { return space.pairs.data() + (y % rows) * width; };
    std::int64_t computed = std::max(down.first, first - patch);  // rows of pairs below this one are computed
    for (std::int64_t y = first; y < last; ++y) {
        const std::int64_t top = std::max(down.first, y - patch), end = std::min(down.last, y + patch + 1);
        for (; computed < end; ++computed) {
            compare(rows_of(match, computed, across.first), rows_of(match, computed + dy, across.first + dx),
                    settings.k * settings.k, settings.epsilon, count, pair_row(computed));
        }
        float* __restrict columns = space.columns.data() + patch;
        std::copy_n(pair_row(top), count, columns);
        for (std::int64_t row = top + 1; row < end; ++row) {
            const float* pairs = pair_row(row);
            for (std::int64_t x = 0; x < count; ++x) columns[x] += pairs[x];
        }
        const float inverse_rows = 1.0f / static_cast<float>(end - top);
        float* __restrict weights = space.weights.data();
        const float* sums = space.columns.data();
        const float* known_there = known.row(0, static_cast<std::uint32_t>(y + dy)) + across.first + dx;
        std::copy_n(sums, count, weights);
        for (std::int64_t o = 1; o < rows; ++o) {
            for (std::int64_t x = 0; x < count; ++x) weights[x] += sums[x + o];
        }
        for (std::int64_t x = 0; x < count; ++x) {
            const float mean = weights[x] * inverse_rows * inverse_counts[x];
            weights[x] = known_there[x] * exp_negative(-std::max(mean, 0.0f));
        }
        const auto here = static_cast<std::uint32_t>(y);
        float* __restrict total = weights_.row(0, here) + across.first;
        for (std::int64_t x = 0; x < count; ++x) total[x] += weights[x];
        for (std::uint32_t c = 0; c < color.components(); ++c) {
            const float* there = color.row(c, static_cast<std::uint32_t>(y + dy)) + across.first + dx;
            float* __restrict to = out.row(c, here) + across.first;
            // Differences, so that constants are preserved exactly.
            const float* own = color.row(c, here) + across.first;
            for (std::int64_t x = 0; x < count; ++x) to[x] += weights[x] * (there[x] - own[x]);
        }
    }
}

}  // namespace tessera::filter

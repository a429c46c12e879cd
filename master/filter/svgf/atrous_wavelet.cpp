#include "master/filter/svgf/atrous_wavelet.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

constexpr std::uint32_t Margin = PaddedPlanes::Margin;
constexpr float Centre = 4.0f / 16.0f, Side = 2.0f / 16.0f, Corner = 1.0f / 16.0f;

// Four of the eight taps; the other four are the same pairs in the opposite direction.
enum Direction : std::size_t { Right, Down, DownRight, DownLeft, DirectionCount };

// Terms of one row for the weights, computed once for the two rows of pairs that use it.
struct RowTerms {
    std::array<float*, DirectionCount> depth_scale;
    float *luminance, *luminance_scale;
};

// One end of a row of pairs.
struct End {
    const float *nx, *ny, *nz, *inverse_depth, *depth_scale, *luminance, *luminance_scale;
    const std::uint32_t* ids;
};

template <Pair Scale>
void pair_weights(const End& a, const End& b, std::size_t count, float kernel, float sigma_n,
                  float* __restrict weights) {
    for (std::size_t x = 0; x < count; ++x) {
        const float dot = a.nx[x] * b.nx[x] + a.ny[x] * b.ny[x] + a.nz[x] * b.nz[x];
        const float depth =
            std::fabs(a.inverse_depth[x] - b.inverse_depth[x]) * std::max(a.depth_scale[x], b.depth_scale[x]);
        const float light = std::fabs(a.luminance[x] - b.luminance[x]) *
                            luminance_scale_of<Scale>(a.luminance_scale[x], b.luminance_scale[x]);
        const float w = kernel * exp_negative(-(normal_distance(dot, sigma_n) + depth + light));
        weights[x] = (a.ids[x] == b.ids[x]) & (dot > 0.0f) ? w : 0.0f;
    }
}

void row_terms(const Guides& guides, const EdgeStops& stops, float step, const PaddedPlanes& from,
               std::uint32_t y, const RowTerms& terms) {
    const std::size_t width = from.width();
    const EdgeStops s = stops;
    const float* inverse = guides.inverse_depth.row(0, y);
    const float *right = guides.slope.row(0, y), *down = guides.slope.row(1, y);
    float* __restrict to_right = terms.depth_scale[Right];
    float* __restrict to_down = terms.depth_scale[Down];
    float* __restrict to_down_right = terms.depth_scale[DownRight];
    float* __restrict to_down_left = terms.depth_scale[DownLeft];
#pragma GCC ivdep  // rows of this thread
    for (std::size_t x = 0; x < width; ++x) {
        const float dx = step * right[x], dy = step * down[x];
        const float steepest = std::max(std::fabs(right[x]), std::fabs(down[x]));
        const float counts = steepest > s.steep * inverse[x] ? 0.0f : 1.0f;
        to_right[x] = counts * depth_scale(inverse[x], dx, s);
        to_down[x] = counts * depth_scale(inverse[x], dy, s);
        to_down_right[x] = counts * depth_scale(inverse[x], dx + dy, s);
        to_down_left[x] = counts * depth_scale(inverse[x], dy - dx, s);
    }
    const float *r = from.row(0, y), *g = from.row(1, y), *b = from.row(2, y), *v = from.row(3, y);
    float* __restrict light = terms.luminance;
    float* __restrict scale = terms.luminance_scale;
    const bool square_root = s.deviation != Deviation::Variance;
    for (std::size_t x = 0; x < width; ++x) {
        const float l = luma(r[x], g[x], b[x]);
        light[x] = l;
        scale[x] = luminance_scale(l, square_root ? std::sqrt(v[x]) : v[x], s);
    }
}

End end_of(const Guides& guides, const RowTerms& terms, Direction direction, std::uint32_t y, std::size_t x) {
    return {guides.normal.row(0, y) + x,
            guides.normal.row(1, y) + x,
            guides.normal.row(2, y) + x,
            guides.inverse_depth.row(0, y) + x,
            terms.depth_scale[direction] + x,
            terms.luminance + x,
            terms.luminance_scale + x,
            guides.ids.data() + std::size_t{y} * guides.inverse_depth.width() + x};
}

}  // namespace

// Rows of one thread, each with a margin on both sides that stays 0.
struct AtrousWavelet::Scratch {
    std::array<RowTerms, 2> terms;                              // of this row and the next one
    std::array<std::array<float*, DirectionCount>, 2> weights;  // of the pairs above and below
    static constexpr std::size_t Rows = 2 * (DirectionCount + 2) + 2 * DirectionCount;

    Scratch(float* memory, std::size_t pitch) {
        const auto next = [&] {
            float* row = memory + Margin;
            memory += pitch;
            return row;
        };
        for (RowTerms& t : terms) {
            for (float*& row : t.depth_scale) row = next();
            t.luminance = next();
            t.luminance_scale = next();
        }
        for (auto& set : weights) {
            for (float*& row : set) row = next();
        }
    }
};

std::uint32_t pass_count(std::uint32_t levels, LevelOrder order) {
    return levels + (order == LevelOrder::BothEnds && levels > 1 ? 1 : 0);
}

std::uint32_t level_of(std::uint32_t pass, std::uint32_t levels, LevelOrder order) {
    switch (order) {
        case LevelOrder::BothEnds:
        case LevelOrder::FirstThenCoarse:
            return pass == 0 ? 0 : (levels - pass) % levels;
        case LevelOrder::Fine:
            return pass;
        case LevelOrder::Coarse:
            return levels - 1 - pass;
    }
    return pass;
}

namespace {

// The weighted mean of the nine taps of row y. Weights outside the picture are 0, and so are the values
// there.
void gather(const PaddedPlanes& from, PaddedPlanes& to, std::uint32_t y, std::size_t step,
            const std::array<float*, DirectionCount>& above,
            const std::array<float*, DirectionCount>& below) {
    const std::size_t width = from.width();
    const std::uint32_t up = y >= step ? y - static_cast<std::uint32_t>(step) : y;
    const std::uint32_t down = y + step < from.height() ? y + static_cast<std::uint32_t>(step) : y;
    const float *w_right = below[Right], *w_left = below[Right] - step;
    const float *w_down = below[Down], *w_up = above[Down];
    const float *w_down_right = below[DownRight], *w_up_left = above[DownRight] - step;
    const float *w_down_left = below[DownLeft], *w_up_right = above[DownLeft] + step;
    const auto s = static_cast<std::ptrdiff_t>(step);
    // All pointers are in locals: reloading them would prevent vectorisation.
    const float *m0 = from.row(0, y), *m1 = from.row(1, y), *m2 = from.row(2, y), *m3 = from.row(3, y);
    const float *a0 = from.row(0, up), *a1 = from.row(1, up), *a2 = from.row(2, up), *a3 = from.row(3, up);
    const float *b0 = from.row(0, down), *b1 = from.row(1, down), *b2 = from.row(2, down),
                *b3 = from.row(3, down);
    float *out0 = to.row(0, y), *out1 = to.row(1, y), *out2 = to.row(2, y), *out3 = to.row(3, y);
    const float* own = from.row(OwnWeightComponent, y);
    float* to_own = to.row(OwnWeightComponent, y);
    const auto sum = [s](const float* m, const float* a, const float* b, std::ptrdiff_t x, float centre,
                         float r, float l, float d, float u, float dr, float ul, float dl, float ur) {
        return centre * m[x] + ((r * m[x + s] + l * m[x - s]) + (d * b[x] + u * a[x])) +
               ((dr * b[x + s] + ul * a[x - s]) + (dl * b[x - s] + ur * a[x + s]));
    };
#pragma GCC ivdep  // `to` is another picture; too many pointers for a check at run time
    for (std::ptrdiff_t x = 0; x < static_cast<std::ptrdiff_t>(width); ++x) {
        const float r = w_right[x], l = w_left[x], d = w_down[x], u = w_up[x];
        const float dr = w_down_right[x], ul = w_up_left[x], dl = w_down_left[x], ur = w_up_right[x];
        const float scale = 1.0f / (Centre + ((r + l) + (d + u)) + ((dr + ul) + (dl + ur)));
        out0[x] = sum(m0, a0, b0, x, Centre, r, l, d, u, dr, ul, dl, ur) * scale;
        out1[x] = sum(m1, a1, b1, x, Centre, r, l, d, u, dr, ul, dl, ur) * scale;
        out2[x] = sum(m2, a2, b2, x, Centre, r, l, d, u, dr, ul, dl, ur) * scale;
        out3[x] = sum(m3, a3, b3, x, Centre * Centre, r * r, l * l, d * d, u * u, dr * dr, ul * ul, dl * dl,
                      ur * ur) *
                  scale * scale;
        to_own[x] = own[x] * (Centre * scale);
    }
}

}  // namespace

bool AtrousWavelet::run(const Guides& guides, const EdgeStops& stops, std::uint32_t level,
                        const PaddedPlanes& from, PaddedPlanes& to, RunContext& context) {
    const std::uint32_t width = from.width(), height = from.height(), step = 1u << level;
    const std::size_t pitch = (std::size_t{width} + 15) / 16 * 16 + 2 * Margin;
    const std::size_t per_thread = Scratch::Rows * pitch;
    scratch_.resize(per_thread * static_cast<std::size_t>(context.arena.max_concurrency()));

    // Rows one step apart share weights: a task processes a band of every step-th row.
    constexpr std::uint32_t BandRows = 48;
    const std::uint32_t phases = std::min(step, height);
    const std::uint32_t rows_per_phase = (height + step - 1) / step;
    const std::uint32_t bands = (rows_per_phase + BandRows - 1) / BandRows;
    return for_rows(context, phases * bands, [&](std::uint32_t task) {
        float* memory = scratch_.data() +
                        per_thread * static_cast<std::size_t>(tbb::this_task_arena::current_thread_index());
        std::fill(memory, memory + per_thread, 0.0f);
        Scratch scratch(memory, pitch);
        const std::uint32_t phase = task % phases, band = task / phases;
        const std::uint32_t first = phase + band * BandRows * step;
        const std::uint64_t end = std::min<std::uint64_t>(height, std::uint64_t{first} + BandRows * step);

        const auto weigh = [&](Direction direction, std::uint32_t y, std::uint32_t other,
                               const RowTerms& here, const RowTerms& there, float* weights) {
            const bool left = direction == DownLeft;
            const std::uint32_t shift = direction == Down ? 0 : step;
            if (shift >= width) return;
            const float kernel = direction == Right || direction == Down ? Side : Corner;
            const auto weights_of =
                stops.pair == Pair::Larger ? pair_weights<Pair::Larger> : pair_weights<Pair::Smaller>;
            weights_of(end_of(guides, here, direction, y, left ? shift : 0),
                       end_of(guides, there, direction, other, left ? 0 : shift), width - shift, kernel,
                       stops.sigma_n, weights + (left ? shift : 0));
        };
        const auto weigh_below = [&](std::uint32_t y) {
            for (const Direction direction : {Down, DownRight, DownLeft}) {
                float* weights = scratch.weights[1][direction];
                if (std::uint64_t{y} + step < height) {
                    weigh(direction, y, y + step, scratch.terms[0], scratch.terms[1], weights);
                } else {
                    std::fill(weights, weights + width, 0.0f);
                }
            }
        };
        const auto next_row = [&](std::uint32_t y) {
            std::swap(scratch.terms[0], scratch.terms[1]);
            std::swap(scratch.weights[0], scratch.weights[1]);
            if (std::uint64_t{y} + step < height) {
                row_terms(guides, stops, static_cast<float>(step), from, y + step, scratch.terms[1]);
            }
        };
        if (first >= end) return;
        if (first >= step) {
            row_terms(guides, stops, static_cast<float>(step), from, first - step, scratch.terms[1]);
            std::swap(scratch.terms[0], scratch.terms[1]);
            row_terms(guides, stops, static_cast<float>(step), from, first, scratch.terms[1]);
            weigh_below(first - step);
        } else {
            row_terms(guides, stops, static_cast<float>(step), from, first, scratch.terms[1]);
        }
        for (std::uint64_t row = first; row < end; row += step) {
            const auto y = static_cast<std::uint32_t>(row);
            next_row(y);
            weigh(Right, y, y, scratch.terms[0], scratch.terms[0], scratch.weights[1][Right]);
            weigh_below(y);
            gather(from, to, y, step, scratch.weights[0], scratch.weights[1]);
        }
    });
}

}  // namespace tessera::filter::svgf

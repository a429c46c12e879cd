#include "master/filter/svgf/atrous_wavelet_5x5.h"

#include <array>

namespace tessera::filter::svgf {

namespace {

constexpr std::uint32_t Margin = PaddedPlanes::Margin;
constexpr std::array<float, 3> Kernel{6.0f / 16.0f, 4.0f / 16.0f, 1.0f / 16.0f};

// Half of the 24 taps; the others are the same pairs in the opposite direction. In steps of the level.
struct Tap {
    std::int32_t dx, dy;
    float kernel() const {
        return Kernel[static_cast<std::size_t>(std::abs(dx))] * Kernel[static_cast<std::size_t>(dy)];
    }
};
constexpr std::array<Tap, 12> Taps{
    {{1, 0}, {2, 0}, {-2, 1}, {-1, 1}, {0, 1}, {1, 1}, {2, 1}, {-2, 2}, {-1, 2}, {0, 2}, {1, 2}, {2, 2}}};
constexpr std::int64_t Reach = 2;  // rows

// One end of a row of pairs.
struct End5x5 {
    const float *nx, *ny, *nz, *inverse_depth, *depth_scale, *luminance, *luminance_scale;
    const std::uint32_t* ids;
};

// As in AtrousWavelet. Shared through a header, inlined or not, it makes that one a quarter slower on tilted surfaces
// (PsvgfSpeed.HardlyDependsOnSceneAndCamera).
template <Pair Scale>
void pair_weights_5x5(const End5x5& a, const End5x5& b, std::size_t count, float kernel, float sigma_n,
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

// What the pairs of one row need, computed once for all of them.
struct RowTerms5x5 {
    std::int64_t row = -1;
    std::array<float*, Taps.size()> depth_scale;
    float *luminance, *luminance_scale;
};

// A thread's rows, with margins that stay 0; those of row y are in the slots y modulo 3.
struct Rows5x5 {
    std::array<RowTerms5x5, Reach + 1> terms;
    std::array<std::array<float*, Taps.size()>, Reach + 1> weights;  // by the pixel at the start of the tap
    std::array<float*, 5> sums;  // of colour and variance, and of the weights
    static constexpr std::size_t Count = (Reach + 1) * (2 * Taps.size() + 2) + 5;

    Rows5x5(float* memory, std::size_t pitch) {
        std::fill(memory, memory + Count * pitch, 0.0f);
        const auto next = [&] {
            float* row = memory + Margin;
            memory += pitch;
            return row;
        };
        for (RowTerms5x5& t : terms) {
            for (float*& row : t.depth_scale) row = next();
            t.luminance = next();
            t.luminance_scale = next();
        }
        for (auto& set : weights) {
            for (float*& row : set) row = next();
        }
        for (float*& row : sums) row = next();
    }
};

// One level of one picture.
class Level5x5 {
  public:
    Level5x5(const Guides& guides, const EdgeStops& stops, std::uint32_t level, const PaddedPlanes& from,
             PaddedPlanes& to)
        : guides_(guides), stops_(stops), step_(std::int64_t{1} << level), from_(from), to_(to) {}

    // Every step-th row from `first` to before `end`; first >= 0.
    void run(Rows5x5& rows, std::int64_t first, std::int64_t end) const {
        for (std::int64_t y = first - Reach * step_; y < end; y += step_) {
            if (y < 0) continue;
            for (std::size_t tap = 0; tap < Taps.size(); ++tap) weigh(rows, y, tap);
            if (y >= first) gather(rows, y);
        }
    }

  private:
    bool has_row(std::int64_t y) const { return y >= 0 && y < std::int64_t{from_.height()}; }
    std::size_t slot(std::int64_t y) const { return static_cast<std::size_t>(y / step_ % (Reach + 1)); }

    const RowTerms5x5& terms_of(Rows5x5& rows, std::int64_t y) const {
        RowTerms5x5& terms = rows.terms[slot(y)];
        if (terms.row == y) return terms;
        terms.row = y;
        const auto row = static_cast<std::uint32_t>(y);
        const std::size_t width = from_.width();
        const EdgeStops s = stops_;
        const float* inverse = guides_.inverse_depth.row(0, row);
        const float *right = guides_.slope.row(0, row), *down = guides_.slope.row(1, row);
        for (std::size_t tap = 0; tap < Taps.size(); ++tap) {
            const float dx = static_cast<float>(Taps[tap].dx * step_),
                        dy = static_cast<float>(Taps[tap].dy * step_);
            float* __restrict to = terms.depth_scale[tap];
#pragma GCC ivdep  // rows of this thread
            for (std::size_t x = 0; x < width; ++x) {
                const float steepest = std::max(std::fabs(right[x]), std::fabs(down[x]));
                const float scale = depth_scale(inverse[x], dx * right[x] + dy * down[x], s);
                to[x] = steepest > s.steep * inverse[x] ? 0.0f : scale;
            }
        }
        const float *r = from_.row(0, row), *g = from_.row(1, row), *b = from_.row(2, row),
                    *v = from_.row(3, row);
        float* __restrict light = terms.luminance;
        float* __restrict scale = terms.luminance_scale;
        const bool square_root = s.deviation != Deviation::Variance;
        for (std::size_t x = 0; x < width; ++x) {
            const float l = luma(r[x], g[x], b[x]);
            light[x] = l;
            scale[x] = luminance_scale(l, square_root ? std::sqrt(v[x]) : v[x], s);
        }
        return terms;
    }

    End5x5 end_at(const RowTerms5x5& terms, std::size_t tap, std::int64_t x) const {
        const auto y = static_cast<std::uint32_t>(terms.row);
        return {
            guides_.normal.row(0, y) + x, guides_.normal.row(1, y) + x,
            guides_.normal.row(2, y) + x, guides_.inverse_depth.row(0, y) + x,
            terms.depth_scale[tap] + x,   terms.luminance + x,
            terms.luminance_scale + x,    guides_.ids.data() + terms.row * std::int64_t{from_.width()} + x};
    }

    // Of the pairs that start in row y. Those that would leave the picture sideways stay 0.
    void weigh(Rows5x5& rows, std::int64_t y, std::size_t tap) const {
        const std::int64_t other = y + Taps[tap].dy * step_, shift = Taps[tap].dx * step_;
        const std::int64_t count = std::int64_t{from_.width()} - std::abs(shift);
        if (!has_row(other) || count <= 0) return;
        const std::int64_t start = std::max<std::int64_t>(0, -shift);
        const auto weights_of =
            stops_.pair == Pair::Larger ? pair_weights_5x5<Pair::Larger> : pair_weights_5x5<Pair::Smaller>;
        weights_of(end_at(terms_of(rows, y), tap, start), end_at(terms_of(rows, other), tap, start + shift),
                   static_cast<std::size_t>(count), Taps[tap].kernel(), stops_.sigma_n,
                   rows.weights[slot(y)][tap] + start);
    }

    void add_tap(Rows5x5& rows, const float* weights, std::int64_t y, std::int64_t shift) const {
        const auto row = static_cast<std::uint32_t>(y);
        const float *r = from_.row(0, row) + shift, *g = from_.row(1, row) + shift,
                    *b = from_.row(2, row) + shift, *v = from_.row(3, row) + shift;
        float* __restrict to_r = rows.sums[0];
        float* __restrict to_g = rows.sums[1];
        float* __restrict to_b = rows.sums[2];
        float* __restrict to_v = rows.sums[3];
        float* __restrict sum = rows.sums[4];
        const std::int64_t width = from_.width();
#pragma GCC ivdep  // rows of this thread; too many pointers for a check at run time
        for (std::int64_t x = 0; x < width; ++x) {
            const float w = weights[x];
            to_r[x] += w * r[x];
            to_g[x] += w * g[x];
            to_b[x] += w * b[x];
            to_v[x] += w * w * v[x];
            sum[x] += w;
        }
    }

    void gather(Rows5x5& rows, std::int64_t y) const {
        const std::size_t width = from_.width();
        const auto row = static_cast<std::uint32_t>(y);
        constexpr float Centre = Kernel[0] * Kernel[0];
        for (std::uint32_t c = 0; c < 4; ++c) {
            const float *values = from_.row(c, row), weight = c == 3 ? Centre * Centre : Centre;
            float* __restrict to = rows.sums[c];
            for (std::size_t x = 0; x < width; ++x) to[x] = weight * values[x];
        }
        std::fill_n(rows.sums[4], width, Centre);
        for (std::size_t tap = 0; tap < Taps.size(); ++tap) {
            const std::int64_t shift = Taps[tap].dx * step_, below = y + Taps[tap].dy * step_,
                               above = y - Taps[tap].dy * step_;
            if (has_row(below)) add_tap(rows, rows.weights[slot(y)][tap], below, shift);
            if (has_row(above)) add_tap(rows, rows.weights[slot(above)][tap] - shift, above, -shift);
        }
        const float* sum = rows.sums[4];
        for (std::uint32_t c = 0; c < 4; ++c) {
            const float* values = rows.sums[c];
            float* __restrict to = to_.row(c, row);
            for (std::size_t x = 0; x < width; ++x) to[x] = values[x] / (c == 3 ? sum[x] * sum[x] : sum[x]);
        }
        const float* own = from_.row(OwnWeightComponent, row);
        float* __restrict to = to_.row(OwnWeightComponent, row);
        for (std::size_t x = 0; x < width; ++x) to[x] = own[x] * Centre / sum[x];
    }

    const Guides& guides_;
    const EdgeStops& stops_;
    std::int64_t step_;
    const PaddedPlanes& from_;
    PaddedPlanes& to_;
};

}  // namespace

bool AtrousWavelet5x5::run(const Guides& guides, const EdgeStops& stops, std::uint32_t level,
                           const PaddedPlanes& from, PaddedPlanes& to, RunContext& context) {
    const std::uint32_t height = from.height(), step = 1u << level;
    const std::size_t pitch = (std::size_t{from.width()} + 15) / 16 * 16 + 2 * Margin;
    const std::size_t per_thread = Rows5x5::Count * pitch;
    scratch_.resize(per_thread * static_cast<std::size_t>(context.arena.max_concurrency()));
    // As in AtrousWavelet: a task processes a band of every step-th row.
    constexpr std::uint32_t BandRows = 48;
    const std::uint32_t phases = std::min(step, height);
    const std::uint32_t bands = ((height + step - 1) / step + BandRows - 1) / BandRows;
    const Level5x5 filter(guides, stops, level, from, to);
    return for_rows(context, phases * bands, [&](std::uint32_t task) {
        Rows5x5 rows(scratch_.data() +
                         per_thread * static_cast<std::size_t>(tbb::this_task_arena::current_thread_index()),
                     pitch);
        const std::uint64_t first = task % phases + std::uint64_t{task / phases} * BandRows * step;
        const std::uint64_t end = std::min<std::uint64_t>(height, first + std::uint64_t{BandRows} * step);
        if (first < end) filter.run(rows, static_cast<std::int64_t>(first), static_cast<std::int64_t>(end));
    });
}

}  // namespace tessera::filter::svgf

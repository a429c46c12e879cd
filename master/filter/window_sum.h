#pragma once

#include <algorithm>
#include <array>

#include "master/filter/kernels.h"

namespace tessera::filter {

// Weighted sums over a window for a stretch of one row. A tap is an offset: every pixel of the stretch adds
// the pixel at that offset, with the weight
//     spatial x known x exp(-sum over guides of (difference)^2)
// The loop over offsets is the outer one, so that a tap is one vectorised loop over pixels.
template <std::uint32_t Guides, std::uint32_t Components>
class WindowSum {
  public:
    static constexpr std::int64_t Stretch = 256;  // the data of a tap stays in the first-level cache

    WindowSum(const Planes& guides, const Planes& color, const Planes& known)
        : guides_(guides), color_(color), known_(known) {}

    // Pixels [first, first + Stretch) of row y, clipped to the row.
    void begin(std::uint32_t y, std::int64_t first) {
        y_ = y;
        first_ = first;
        last_ = std::min<std::int64_t>(first + Stretch, color_.width());
        for (auto& row : sums_) row.fill(0.0f);
        for (auto& row : part_) row.fill(0.0f);
    }

    // Offsets out of the picture add nothing.
    void tap(std::int64_t dx, std::int64_t dy, float spatial) {
        const std::int64_t row = y_ + dy;
        if (row < 0 || row >= std::int64_t{color_.height()}) return;
        const std::int64_t from = std::max(first_, -dx),
                           to = std::min(last_, std::int64_t{color_.width()} - dx);
        if (from >= to) return;
        const auto there = static_cast<std::uint32_t>(row);
        std::array<const float*, Guides> centre, other;
        for (std::uint32_t g = 0; g < Guides; ++g) {
            centre[g] = guides_.row(g, y_) + from;
            other[g] = guides_.row(g, there) + from + dx;
        }
        std::array<const float*, Components> color;
        for (std::uint32_t c = 0; c < Components; ++c) color[c] = color_.row(c, there) + from + dx;
        const float* known = known_.row(0, there) + from + dx;
        std::array<float*, Components + 1> sums;
        for (std::uint32_t c = 0; c <= Components; ++c) sums[c] = part_[c].data() + (from - first_);
        add(centre, other, color, known, spatial, sums, to - from);
    }

    // To be called after every few taps: partial sums reduce rounding.
    void close_part() {
        for (std::uint32_t c = 0; c <= Components; ++c) {
            for (std::size_t x = 0; x < Stretch; ++x) sums_[c][x] += part_[c][x];
            part_[c].fill(0.0f);
        }
    }

    // The weighted means go to row y of `out`; the centre's own value where no pixel with samples is similar.
    void write(Planes& out) const {
        for (std::uint32_t c = 0; c < Components; ++c) {
            float* __restrict to = out.row(c, y_) + first_;
            const float* own = color_.row(c, y_) + first_;
            for (std::int64_t x = 0; x < last_ - first_; ++x) {
                const float w = sums_[Components][static_cast<std::size_t>(x)];
                to[x] = w > Least ? sums_[c][static_cast<std::size_t>(x)] / w : own[x];
            }
        }
    }

  private:
    static constexpr float Least = 1e-30f;  // below it a weight has no significant digits

    static void add(const std::array<const float*, Guides>& centre,
                    const std::array<const float*, Guides>& other,
                    const std::array<const float*, Components>& color, const float* known, float spatial,
                    const std::array<float*, Components + 1>& sums, std::int64_t count) {
        float* __restrict sum0 = sums[0];
        float* __restrict sum1 = sums[1];
        float* __restrict sum2 = sums[2];
        float* __restrict sum3 = sums[3];  // alpha, or the weights
        float* __restrict weights = sums[Components];
        const auto centres = centre;
        const auto others = other;
        const auto colors = color;
        for (std::int64_t x = 0; x < count; ++x) {
            float distance = 0.0f;
            for (std::uint32_t g = 0; g < Guides; ++g) {
                const float difference = centres[g][x] - others[g][x];
                distance += difference * difference;
            }
            const float w = spatial * known[x] * exp_negative(-distance);
            weights[x] += w;
            sum0[x] += w * colors[0][x];
            sum1[x] += w * colors[1][x];
            sum2[x] += w * colors[2][x];
            if constexpr (Components == 4) sum3[x] += w * colors[3][x];
        }
    }

    const Planes &guides_, &color_, &known_;
    std::uint32_t y_ = 0;
    std::int64_t first_ = 0, last_ = 0;
    std::array<std::array<float, Stretch>, Components + 1> sums_, part_;  // the last: weights
};

// Row y of `to`. add_taps(): the taps of the window, for one stretch of the row.
template <class Sum, class AddTaps>
void sum_windows(Sum& sum, std::uint32_t y, Planes& to, const AddTaps& add_taps) {
    for (std::int64_t first = 0; first < std::int64_t{to.width()}; first += Sum::Stretch) {
        sum.begin(y, first);
        add_taps();
        sum.write(to);
    }
}

// Factor from a difference to the square root of its exponent.
inline float scale_of(double sigma) {
    return static_cast<float>(1.0 / (std::sqrt(2.0) * sigma));
}

}  // namespace tessera::filter

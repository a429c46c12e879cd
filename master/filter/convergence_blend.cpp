#include "master/filter/convergence_blend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "master/filter/box_sum.h"
#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

// A component whose Scale is that of the light as a whole: alpha's.
constexpr std::uint32_t Grey = 3;

// Relative deviations and differences, so that sums of squares stay finite.
constexpr float Most = 1e15f, Largest = 1e37f;

constexpr std::size_t Bands = ConvergenceBlend::Bands;

// As std::min, std::max and std::clamp, which return references: loops with those are not vectorised.
float smaller(float a, float b) {
    return b < a ? b : a;
}
float larger(float a, float b) {
    return a < b ? b : a;
}
float limited(float x, float low, float high) {
    return smaller(larger(x, low), high);
}

// Per pixel, summed over r, g, b: relative to F the variance of U - F, its square and its root, and the squares of the
// bands; |F| and the variance of U in units of the floor.
enum Term : std::uint32_t {
    Noise,
    NoiseSquare,
    Amplitude,
    Light,
    Variance,
    Square,
    TermCount = Square + Bands
};
constexpr std::array<std::uint32_t, 4> ForUnseen{Noise, Amplitude, Light, Variance};
constexpr std::array<std::uint32_t, 2 + Bands> ForWeights{Noise, NoiseSquare, Square, Square + 1, Square + 2};
// Once the weights are known: S times the relative deviation of the pixels around, at most S; the probability that light
// is rare.
constexpr Term PooledNoise = Amplitude, Rareness = Light;

// The variance of each band where every pixel has independent noise of variance 1, from the sums of squares and of
// products of the kernels.
constexpr double squared(double x) {
    return x * x;
}
constexpr double Own = squared(2.0 / 4.0), Narrow = squared(6.0 / 16.0), Both = squared(14.0 / 64.0),
                 Wide = squared(44.0 / 256.0);
constexpr std::array<float, Bands> NoiseGain{static_cast<float>(1.0 - 2.0 * Own + Narrow),
                                             static_cast<float>(Narrow - 2.0 * Both + Wide),
                                             static_cast<float>(Wide)};

// What differences are divided by: light by its own brightness, alpha by that of the light, whose weights it has.
struct Scale {
    Scale(const Planes& filtered, std::uint32_t component, std::uint32_t y, float floor)
        : r_(filtered.row(component < 3 ? component : 0, y)),
          g_(filtered.row(component < 3 ? component : 1, y)),
          b_(filtered.row(component < 3 ? component : 2, y)),
          floor_(floor) {}
    float at(std::size_t x) const {
        constexpr float Third = 1.0f / 3.0f;
        const float mean = Third * std::abs(r_[x]) + Third * std::abs(g_[x]) + Third * std::abs(b_[x]);
        return smaller(mean + floor_, 3e38f);
    }

  private:
    const float *r_, *g_, *b_;
    float floor_;
};

// U - F of one row, 0 where the variance is unknown, the same relative to F, and its relative variance.
void fill_residual(const Inputs& inputs, frame::Channel filtered_part, const Planes& filtered,
                   std::span<const float> self_weight, float floor, std::uint32_t y, Planes& residual,
                   Planes& relative, Planes& terms) {
    const std::uint32_t width = inputs.width;
    const float* counts = inputs.counts.row(0, y);
    for (std::uint32_t c = 0; c < filtered.components(); ++c) {
        const float* u = inputs.color(c).data() + std::size_t{y} * width;
        const float* f = filtered.row(c, y);
        const Scale scale(filtered, c, y, floor);
        float *to = residual.row(c, y), *relative_to = relative.row(c, y);
#pragma GCC ivdep  // rows of different planes; too many pointers for a check at run time
        for (std::uint32_t x = 0; x < width; ++x) {
            const float any = limited(u[x] - f[x], -Largest, Largest);
            const float difference = counts[x] >= 2.0f ? any : 0.0f;
            to[x] = difference;
            relative_to[x] = limited(difference / scale.at(x), -Most, Most);
        }
    }
    float *noise = terms.row(Noise, y), *light = terms.row(Light, y), *variance = terms.row(Variance, y);
    for (float* term : {noise, light, variance}) std::fill(term, term + width, 0.0f);
    const float per_floor = 1.0f / floor;
    for (std::uint32_t c = 0; c < 3; ++c) {
        const float* v = inputs.variance(filtered_part).row(c, y);
        const float* f = filtered.row(c, y);
#pragma GCC ivdep  // as above
        for (std::uint32_t x = 0; x < width; ++x) {
            const float known = counts[x] >= 2.0f ? 1.0f : 0.0f;
            const float error = std::sqrt(v[x]) * known;
            const float deviation = smaller(error / (std::abs(f[x]) + floor), Most);
            const float in_floors = smaller(error * per_floor, Most);
            noise[x] += deviation * deviation;
            light[x] += smaller(std::abs(f[x]) * per_floor, Most) * known;
            variance[x] += in_floors * in_floors;
        }
    }
    if (!self_weight.empty()) {
        const float* a = self_weight.data() + std::size_t{y} * width;
        for (std::uint32_t x = 0; x < width; ++x) noise[x] *= 1.0f - a[x];
    }
    float *square = terms.row(NoiseSquare, y), *amplitude = terms.row(Amplitude, y);
    for (std::uint32_t x = 0; x < width; ++x) {
        square[x] = noise[x] * noise[x];
        amplitude[x] = std::sqrt(noise[x]);
    }
}

// The two kernels, in both directions, up to their middle; beyond the border the last pixel goes on.
constexpr std::array<float, 2> NarrowKernel{0.25f, 0.5f};
constexpr std::array<float, 4> WideKernel{0.0625f, 0.125f, 0.1875f, 0.25f};

// `column`: scratch, width + 6.
template <std::size_t Size>
void smooth_row(const Planes& from, std::uint32_t c, std::uint32_t y, const std::array<float, Size>& kernel,
                float* __restrict column, float* __restrict to) {
    constexpr std::uint32_t Radius = Size - 1;
    const std::uint32_t width = from.width(), last = from.height() - 1;
    float* __restrict sum = column + Radius;
    std::array<const float*, Size> above, below;
    for (std::uint32_t d = 0; d <= Radius; ++d) {
        above[d] = from.row(c, y > d ? y - d : 0);
        below[d] = from.row(c, std::min(last, y + d));
    }
#pragma GCC ivdep  // scratch; too many pointers for a check at run time
    for (std::uint32_t x = 0; x < width; ++x) {
        float value = kernel[Radius] * above[0][x];
#pragma GCC unroll 4
        for (std::uint32_t d = 1; d <= Radius; ++d) value += kernel[Radius - d] * (above[d][x] + below[d][x]);
        sum[x] = value;
    }
    std::fill(column, sum, sum[0]);
    std::fill(sum + width, sum + width + Radius, sum[width - 1]);
    for (std::uint32_t x = 0; x < width; ++x) {
        float value = kernel[Radius] * sum[x];
#pragma GCC unroll 4
        for (std::uint32_t d = 1; d <= Radius; ++d)
            value += kernel[Radius - d] * (column[x + Radius - d] + column[x + Radius + d]);
        to[x] = value;
    }
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

// Sums of terms over the squares around the pixels of a block of rows, clipped to the picture.
class SquareSums {
  public:
    static constexpr std::uint32_t Rows = 16;

    static std::uint32_t block_count(std::uint32_t height) { return (height + Rows - 1) / Rows; }
    // Numbers of memory for as many terms.
    static std::size_t size(std::size_t width, std::uint32_t radius, std::size_t terms) {
        return terms * Rows * width + (Rows + 2 * radius) * (2 * width + 2 * radius);
    }

    SquareSums(const Planes& terms, std::span<const std::uint32_t> which, std::uint32_t block,
               std::uint32_t radius, float* memory)
        : width_(terms.width()),
          first_(block * Rows),
          count_(std::min(Rows, terms.height() - first_)),
          sums_(memory) {
        const std::size_t pitch = width_ + 2 * std::size_t{radius};
        float* values = memory + which.size() * Rows * width_;
        float* between = values + (Rows + 2 * radius) * pitch;
        for (std::size_t i = 0; i < which.size(); ++i) {
            std::fill(values, between, 0.0f);
            const std::uint32_t from = first_ > radius ? first_ - radius : 0;
            const std::uint32_t to = std::min(terms.height(), first_ + Rows + radius);
            for (std::uint32_t y = from; y < to; ++y)
                std::copy_n(terms.row(which[i], y), width_, values + (y + radius - first_) * pitch + radius);
            box_sum(values, pitch, width_, Rows, 2 * std::size_t{radius} + 1, between,
                    memory + i * Rows * width_);
        }
    }

    std::uint32_t first_row() const { return first_; }
    std::uint32_t row_count() const { return count_; }
    // Of term `which[i]` around the pixels of row first_row() + `row`.
    const float* row(std::size_t i, std::uint32_t row) const { return sums_ + (i * Rows + row) * width_; }

  private:
    std::size_t width_;
    std::uint32_t first_, count_;
    const float* sums_;
};

// Of the mean variance around it: a pixel with less has seen next to nothing of what causes that variance.
constexpr float UnseenShare = 0.02f;
constexpr float LeastDarker = 1e-3f;  // of the brightness of U to that of F: above 0 for any U
constexpr float RareArea = 25.0f;     // pixels that see at most one find where light is rare
constexpr float MostExpected = 1e6f;  // finds
// So many finds of unequal strengths are hardly all missed, and twice as many never.
constexpr float CommonFinds = 16.0f;

// What the pixels of a row have themselves, and the sums over the squares around them.
struct UnseenRow {
    const float *own_noise, *own_light;
    const float *noise, *amplitude, *light, *variance;
};

// Of a Poisson distribution with this mean.
float at_most_one(float mean) {
    return exp_negative(-mean) * (1.0f + mean);
}
float at_most_three(float mean) {
    return exp_negative(-mean) * (1.0f + mean * (1.0f + mean * (1.0f / 2.0f + mean / 6.0f)));
}

// Of the pixels of one row that have seen next to nothing of the light that makes the noise around them: the
// probability that the light of F is not there. 0 elsewhere. `area`: pixels of a square.
void find_unseen(const UnseenRow& row, std::size_t width, float area, float* __restrict unseen) {
    for (std::size_t x = 0; x < width; ++x) {
        const float finds = row.amplitude[x] * row.amplitude[x] / std::max(row.noise[x], 1e-37f);
        const float few = at_most_three(finds), rare = at_most_one(finds * (RareArea / area));
        // 1e18 keeps the product below finite.
        const float per_light = std::min(row.light[x] / std::max(row.variance[x], 1e-37f), 1e18f);
        const float expected = std::min(row.own_light[x] * per_light, MostExpected);
        const float missed = 1.0f - exp_negative(-expected);
        const float common = std::clamp(expected / CommonFinds - 1.0f, 0.0f, 1.0f);
        const bool is_dark = row.own_noise[x] * area < UnseenShare * row.noise[x];
        unseen[x] = is_dark ? std::max(std::max(few, rare * missed), common) : 0.0f;
    }
}

// The probability that RareArea pixels of a square have at most one find, by the noise and its squares.
void find_rareness(const float* noise, const float* square, std::size_t width, float area,
                   float* __restrict rareness) {
    for (std::size_t x = 0; x < width; ++x) {
        const float ratio = noise[x] / std::sqrt(std::max(square[x], 1e-37f));  // squares may be infinite
        const float finds = std::min(ratio * ratio, area);
        rareness[x] = at_most_one(finds * (RareArea / area));
    }
}

// The bands of one row and component.
struct BandRow {
    const float *relative, *narrow, *wide;
    Scale scale;

    struct Values {
        float fine, middle, coarse;
    };
    Values at(std::size_t x) const {
        const float s = scale.at(x);
        const float coarser = limited(narrow[x] * s, -Largest, Largest);
        return {limited((relative[x] - narrow[x]) * s, -Largest, Largest), coarser - wide[x], wide[x]};
    }
};

BandRow bands_of(const Planes& relative, const Planes& narrow, const Planes& wide, const Planes& filtered,
                 float floor, std::uint32_t c, std::uint32_t y) {
    return {relative.row(c, y), narrow.row(c, y), wide.row(c, y), Scale(filtered, c, y, floor)};
}

// The relative squares of the bands in one row.
void fill_squares(BandRow row, const float* unseen, std::uint32_t y, Planes& terms) {
    const std::uint32_t width = terms.width();
    float *fine = terms.row(Square, y), *middle = terms.row(Square + 1, y),
          *coarse = terms.row(Square + 2, y);
#pragma GCC ivdep  // rows of different planes; too many pointers for a check at run time
    for (std::uint32_t x = 0; x < width; ++x) {
        // U + floor is (F + floor) (1 + residual).
        const float darker = larger(1.0f + row.relative[x], LeastDarker);
        const float raised = row.relative[x] < 0.0f ? 1.0f / darker : 1.0f;
        const float factor = 1.0f + unseen[x] * (raised * raised - 1.0f);
        const float inverse = 1.0f / row.scale.at(x);
        const BandRow::Values bands = row.at(x);
        const auto square = [inverse, factor](float d) {
            const float relative = limited(d * inverse, -Most, Most);
            return relative * relative * factor;
        };
        fine[x] += square(bands.fine);
        middle[x] += square(bands.middle);
        coarse[x] += square(bands.coarse);
    }
}

// w of one band.
void divide(const float* noise, const float* uncertainty, const float* square, std::size_t width, float gain,
            float* __restrict weight) {
    for (std::size_t x = 0; x < width; ++x) {
        const float variance = gain * noise[x];
        const float deviation = gain * std::sqrt(0.5f * uncertainty[x]);
        const float bias = std::max(0.0f, square[x] - variance - deviation);
        const float w = variance / std::max(variance + bias, 1e-37f);
        weight[x] = bias > 0.0f ? w : 1.0f;
    }
}

}  // namespace

bool ConvergenceBlend::weigh(const Inputs& inputs, frame::Channel filtered_part,
                             std::span<const float> self_weight, const Planes& filtered, float floor,
                             RunContext& context) {
    shape(terms_, inputs, TermCount);
    shape(weights_, inputs, Bands);
    for (Planes* planes : {&residual_, &wide_, &relative_, &narrow_})
        shape(*planes, inputs, filtered.components());
    const std::size_t width = inputs.width;
    scratch_.reserve(context, SquareSums::size(width, radius_, ForWeights.size()) + 2 * width + 6);
    const std::uint32_t blocks = SquareSums::block_count(inputs.height);
    const float side = 2.0f * static_cast<float>(radius_) + 1.0f, area = side * side;
    return for_rows(context, inputs.height,
                    [&](std::uint32_t y) {
                        fill_residual(inputs, filtered_part, filtered, self_weight, floor, y, residual_,
                                      relative_, terms_);
                    }) &&
           for_rows(context, blocks, [&](std::uint32_t block) { fill_bands(filtered, floor, block); }) &&
           for_rows(context, blocks, [&](std::uint32_t block) {
               const SquareSums sums(terms_, ForWeights, block, radius_, scratch_.local());
               for (std::uint32_t i = 0; i < sums.row_count(); ++i) {
                   // Its term is not among the sums of other blocks, which may still be to come.
                   float* noise = terms_.row(PooledNoise, sums.first_row() + i);
                   const Scale scale(filtered, Grey, sums.first_row() + i, floor);
                   for (std::size_t x = 0; x < width; ++x)
                       noise[x] = std::min(std::sqrt(sums.row(0, i)[x] / area), 1.0f) * scale.at(x);
                   find_rareness(sums.row(0, i), sums.row(1, i), width, area,
                                 terms_.row(Rareness, sums.first_row() + i));
                   for (std::uint32_t band = 0; band < Bands; ++band) {
                       divide(sums.row(0, i), sums.row(1, i), sums.row(2 + band, i), width, NoiseGain[band],
                              weights_.row(band, sums.first_row() + i));
                   }
               }
           });
}

void ConvergenceBlend::fill_bands(const Planes& filtered, float floor, std::uint32_t block) {
    const std::size_t width = filtered.width();
    const SquareSums sums(terms_, ForUnseen, block, radius_, scratch_.local());
    float* unseen = scratch_.local() + SquareSums::size(width, radius_, ForUnseen.size());
    const float side = 2.0f * static_cast<float>(radius_) + 1.0f;
    for (std::uint32_t i = 0; i < sums.row_count(); ++i) {
        const std::uint32_t y = sums.first_row() + i;
        find_unseen({terms_.row(Noise, y), terms_.row(Light, y), sums.row(0, i), sums.row(1, i),
                     sums.row(2, i), sums.row(3, i)},
                    width, side * side, unseen);
        for (std::uint32_t band = 0; band < Bands; ++band)
            std::fill_n(terms_.row(Square + band, y), width, 0.0f);
        for (std::uint32_t c = 0; c < filtered.components(); ++c) {
            smooth_row(relative_, c, y, NarrowKernel, unseen + width, narrow_.row(c, y));
            smooth_row(residual_, c, y, WideKernel, unseen + width, wide_.row(c, y));
            if (c < 3)
                fill_squares(bands_of(relative_, narrow_, wide_, filtered, floor, c, y), unseen, y, terms_);
        }
    }
}

bool ConvergenceBlend::apply(const Inputs& inputs, frame::Channel filtered_part,
                             std::span<const float> self_weight, Planes& picture, RunContext& context) {
    const float floor = floor_of(picture, row_sums_, context);
    if (!weigh(inputs, filtered_part, self_weight, picture, floor, context)) return false;
    const bool done = for_rows(context, inputs.height, [&](std::uint32_t y) {
        const float *fine = weights_.row(0, y), *middle = weights_.row(1, y), *coarse = weights_.row(2, y);
        const float* rareness = terms_.row(Rareness, y);
        const float* counts = inputs.counts.row(0, y);
        // Alpha, which is scaled by the light, first.
        for (std::uint32_t c = picture.components(); c-- > 0;) {
            const BandRow row = bands_of(relative_, narrow_, wide_, picture, floor, c, y);
            float* f = picture.row(c, y);
            const float* u = inputs.color(c).data() + std::size_t{y} * inputs.width;
            const float most = c == 3 ? 1.0f : std::numeric_limits<float>::max();
#pragma GCC ivdep  // a pixel depends on no other
            for (std::uint32_t x = 0; x < inputs.width; ++x) {
                const BandRow::Values d = row.at(x);
                const float change =
                    (1.0f - fine[x]) * d.fine + (1.0f - middle[x]) * d.middle + (1.0f - coarse[x]) * d.coarse;
                // Where light is rare, the coarse bands take it to pixels that found none.
                const float beyond = larger(0.0f, f[x] + change - larger(f[x], u[x]));
                const float blended = f[x] + change - rareness[x] * beyond;
                // What lies in a range is never further from its nearest value than from one outside.
                f[x] = counts[x] >= 2.0f ? limited(blended, 0.0f, most) : f[x];
            }
        }
    });
    return done && lost_light_.restore(inputs, filtered_part, terms_.plane(PooledNoise), picture, context);
}

}  // namespace tessera::filter

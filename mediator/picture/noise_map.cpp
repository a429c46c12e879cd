#include "mediator/picture/noise_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/base/bands.h"
#include "mediator/frame/design_effect.h"
#include "mediator/picture/color.h"

namespace tessera::picture {

namespace {

constexpr std::size_t BrightnessRadius = 2, DeviationRadius = 4;
constexpr double RareShare = 1.0 / 8.0;

enum class Own : std::uint8_t { Included, LeftOut };

constexpr std::size_t BandRows = 16;

// Rows of a picture, in bands.
struct Rows {
    std::size_t width, height;
    tbb::task_arena* arena;

    // function(first, last) of the pixels of a band.
    template <class Function>
    void each(const Function& function) const {
        for_bands(arena, height, BandRows,
                  [&](std::size_t first, std::size_t last) { function(first * width, last * width); });
    }
};

// Sums over squares around each pixel, clipped to the picture; its own value is never subtracted, which would leave rounding.
class SquareSum {
  public:
    explicit SquareSum(const Rows& rows) : rows_(rows) {}

    void apply(std::vector<float>& values, std::size_t radius, Own own = Own::Included) {
        across_.resize(values.size());
        if (own == Own::LeftOut) across_others_.resize(values.size());
        for_bands(rows_.arena, rows_.height, BandRows, [&](std::size_t first, std::size_t last) {
            std::vector<float> padded(rows_.width + 2 * radius, 0.0f);
            for (std::size_t y = first; y < last; ++y) sum_row(values, y, radius, own, padded);
        });
        for_bands(rows_.arena, rows_.height, BandRows, [&](std::size_t first, std::size_t last) {
            for (std::size_t y = first; y < last; ++y) {
                float* const to = &values[y * rows_.width];
                std::fill_n(to, rows_.width, 0.0f);
                const std::size_t end = std::min(rows_.height, y + radius + 1);
                for (std::size_t k = y < radius ? 0 : y - radius; k < end; ++k) {
                    const std::vector<float>& from = k == y && own == Own::LeftOut ? across_others_ : across_;
                    add(to, &from[k * rows_.width]);
                }
            }
        });
    }

  private:
    void sum_row(const std::vector<float>& values, std::size_t y, std::size_t radius, Own own,
                 std::vector<float>& padded) {
        const std::size_t at = y * rows_.width;
        std::copy_n(&values[at], rows_.width, &padded[radius]);
        float* const row = &across_[at];
        std::fill_n(row, rows_.width, 0.0f);
        for (std::size_t k = 0; k <= 2 * radius; ++k) {
            if (k != radius) add(row, &padded[k]);
        }
        if (own == Own::LeftOut) std::copy_n(row, rows_.width, &across_others_[at]);
        add(row, &padded[radius]);
    }
    void add(float* to, const float* from) const {
        for (std::size_t x = 0; x < rows_.width; ++x) to[x] += from[x];
    }
    Rows rows_;
    std::vector<float> across_, across_others_;
};

// Squared brightness of each pixel in one component. Its mean is shrunk to that of its neighbours as far as their differences
// are noise (Wiener): a pixel that found little would count too much if it were divided by itself, and one in a fine shadow
// too little if it were divided by its neighbours. What is left of the variance is added: the square's expectation.
class Brightness {
  public:
    Brightness(const Rows& rows, std::span<const float> known)
        : rows_(rows), squares_(rows), known_(known), count_(known.begin(), known.end()) {
        squares_.apply(count_, BrightnessRadius);
    }

    // `variance`: of the mean, finite.
    void estimate(std::span<const float> mean, std::span<const float> variance) {
        for (std::vector<float>* sum : {&value_, &others_, &sum_of_squares_, &noise_})
            sum->resize(mean.size());
        rows_.each([&](std::size_t first, std::size_t last) {
            constexpr float Largest = 1e18f;  // its square is finite
            for (std::size_t i = first; i < last; ++i) {
                const float value = known_[i] > 0.0f ? std::clamp(mean[i], -Largest, Largest) : 0.0f;
                value_[i] = others_[i] = value;
                sum_of_squares_[i] = value * value;
                noise_[i] = known_[i] * variance[i];
            }
        });
        squares_.apply(others_, BrightnessRadius, Own::LeftOut);
        for (std::vector<float>* sum : {&sum_of_squares_, &noise_}) squares_.apply(*sum, BrightnessRadius);
        rows_.each([&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                if (known_[i] > 0.0f) shrink(i, variance[i]);
            }
        });
    }
    // With and without the pixel among its neighbours.
    std::span<const float> of_all() const { return value_; }
    std::span<const float> of_others() const { return others_; }

  private:
    void shrink(std::size_t i, float variance) {
        const float near = (others_[i] + value_[i]) / count_[i];
        // Two standard errors of the variance of so many normally distributed means are no difference.
        const float chance = 1.0f + 2.0f * std::sqrt(2.0f / count_[i]);
        const float differences =
            std::max(0.0f, (sum_of_squares_[i] - chance * noise_[i]) / count_[i] - near * near);
        const float own = differences > 0.0f ? differences / (differences + variance) : 0.0f;
        const float others = count_[i] > 1.0f ? others_[i] / (count_[i] - 1.0f) : near;
        const auto square = [&](float prior) {
            const float value = prior + own * (value_[i] - prior);
            return value * value + own * variance;
        };
        others_[i] = square(others);
        value_[i] = square(near);
    }

    Rows rows_;
    SquareSum squares_;
    std::span<const float> known_;
    std::vector<float> count_, value_, others_, sum_of_squares_, noise_;
};

// A tenth of the mean luminance, squared, as in relMSE. Nothing: no pixel has a sample.
float floor_of(const frame::FilmTile& film, std::uint32_t radiance) {
    double light = 0.0;
    std::size_t known = 0;
    for (std::size_t i = 0; i < film.pixel_count(); ++i) {
        if (film.counts[i] == 0) continue;
        light += luminance(film.plane(radiance)[i], film.plane(radiance + 1)[i], film.plane(radiance + 2)[i]);
        ++known;
    }
    const double mean = known > 0 ? light / static_cast<double>(known) : 0.0;
    return static_cast<float>(std::clamp(0.01 * mean * mean, 1e-30, 1e30));
}

// Averages the deviations of pixels. `known`: 1 for those with two samples or more, `count` of them.
void average(const Rows& rows, const frame::FilmTile& film, std::vector<float>& known,
             const std::vector<float>& per_sample, const std::vector<float>& finds, double count,
             std::vector<float>& deviations) {
    SquareSum squares(rows);
    squares.apply(deviations, DeviationRadius);
    squares.apply(known, DeviationRadius);
    double excess = 0.0;
    for (std::size_t i = 0; i < deviations.size(); ++i) {
        deviations[i] /= std::max(known[i], 1.0f);
        if (film.counts[i] < 2) continue;
        const float beyond = per_sample[i] - deviations[i] * deviations[i];
        if (beyond > 0.0f) excess += double(beyond) / std::max(double(finds[i]), 1.0);
    }
    const auto rare = static_cast<float>(RareShare * excess / count);
    rows.each([&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i)
            deviations[i] = std::sqrt(deviations[i] * deviations[i] + rare);
    });
}

}  // namespace

NoiseMap::NoiseMap(const frame::FilmTile& film, tbb::task_arena* arena)
    : deviations_(film.pixel_count(), 0.0f) {
    const Rows rows{static_cast<std::size_t>(film.rect.width), static_cast<std::size_t>(film.rect.height),
                    arena};
    const std::uint32_t first_plane = film.channels.first_plane(frame::Channel::Radiance);
    const std::size_t pixels = film.pixel_count();
    const float floor = floor_of(film, first_plane);
    frame::DesignEffect design_effect;
    const std::span<const float> effects = design_effect.measure(film, arena);
    std::vector<float> known(pixels);
    for (std::size_t i = 0; i < pixels; ++i) known[i] = film.counts[i] >= 2 ? 1.0f : 0.0f;
    Brightness brightness(rows, known);
    std::vector<float> per_sample(pixels), variance(pixels), finds(pixels);
    double relative = 0.0, count = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        const std::span<const float> mean = film.plane(first_plane + c), m2 = film.plane(first_plane + 3 + c);
        rows.each([&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                const float n = static_cast<float>(film.counts[i]);
                // Finite, so that one pixel does not make the whole picture infinite.
                variance[i] = known[i] > 0.0f ? std::min(m2[i] / ((n - 1.0f) * n) * effects[i], 1e30f) : 0.0f;
            }
        });
        brightness.estimate(mean, variance);
        const std::span<const float> of_all = brightness.of_all(), of_others = brightness.of_others();
        rows.each([&](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) {
                if (known[i] == 0.0f) continue;
                const float n = static_cast<float>(film.counts[i]);
                per_sample[i] += std::min(variance[i] * n / (of_all[i] + floor), 1e30f) / 3.0f;
                variance[i] = std::min(variance[i] / (of_others[i] + floor), 1e30f);
                // (sum x)^2 / sum x^2
                const double sum = double(n) * double(mean[i]);
                const double squares_sum = double(m2[i]) + sum * double(mean[i]);
                finds[i] += squares_sum > 0.0 ? static_cast<float>(sum * sum / squares_sum / 3.0) : 0.0f;
            }
        });
        // In the order of the pixels, whatever threads there are.
        for (std::size_t i = 0; i < pixels; ++i) {
            if (known[i] > 0.0f) relative += double(variance[i]) / 3.0;
        }
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        if (known[i] == 0.0f) continue;
        count += 1.0;
        deviations_[i] = std::sqrt(per_sample[i]);
    }
    if (count == 0.0) return;
    noise_ = std::sqrt(relative / count);
    average(rows, film, known, per_sample, finds, count, deviations_);
}

std::vector<float> noise_of_pixels(const frame::FilmTile& film) {
    std::vector<float> noise = NoiseMap(film).deviations();
    for (std::size_t i = 0; i < noise.size(); ++i)
        noise[i] = film.counts[i] < 2 ? 0.0f : noise[i] / std::sqrt(static_cast<float>(film.counts[i]));
    return noise;
}

}  // namespace tessera::picture

#include "mediator/picture/noise_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/frame/design_effect.h"
#include "mediator/picture/color.h"

namespace tessera::picture {

namespace {

constexpr std::ptrdiff_t BrightnessRadius = 2, DeviationRadius = 4;
constexpr double RareShare = 1.0 / 8.0;

enum class Own : std::uint8_t { Included, LeftOut };

// Sums over squares around each pixel, clipped to the picture; its own value is never subtracted, which would leave rounding.
class SquareSum {
  public:
    SquareSum(std::ptrdiff_t width, std::ptrdiff_t height) : width_(width), height_(height) {}

    void apply(std::vector<float>& values, std::ptrdiff_t radius, Own own = Own::Included) {
        rows_.resize(values.size());
        if (own == Own::LeftOut) rows_of_others_.resize(values.size());
        padded_.assign(static_cast<std::size_t>(width_ + 2 * radius), 0.0f);
        for (std::ptrdiff_t y = 0; y < height_; ++y) {
            std::copy_n(values.begin() + y * width_, width_, padded_.begin() + radius);
            float* const row = &rows_[static_cast<std::size_t>(y * width_)];
            std::fill_n(row, width_, 0.0f);
            for (std::ptrdiff_t k = 0; k <= 2 * radius; ++k) {
                if (k != radius) add(row, &padded_[static_cast<std::size_t>(k)]);
            }
            if (own == Own::LeftOut)
                std::copy_n(row, width_, &rows_of_others_[static_cast<std::size_t>(y * width_)]);
            add(row, &padded_[static_cast<std::size_t>(radius)]);
        }
        for (std::ptrdiff_t y = 0; y < height_; ++y) {
            float* const to = &values[static_cast<std::size_t>(y * width_)];
            std::fill_n(to, width_, 0.0f);
            const std::ptrdiff_t last = std::min(height_ - 1, y + radius);
            for (std::ptrdiff_t k = std::max<std::ptrdiff_t>(0, y - radius); k <= last; ++k) {
                const std::vector<float>& rows = k == y && own == Own::LeftOut ? rows_of_others_ : rows_;
                add(to, &rows[static_cast<std::size_t>(k * width_)]);
            }
        }
    }

  private:
    void add(float* to, const float* from) const {
        for (std::ptrdiff_t x = 0; x < width_; ++x) to[x] += from[x];
    }
    std::ptrdiff_t width_, height_;
    std::vector<float> rows_, rows_of_others_, padded_;
};

// Squared brightness of each pixel in one component. Its mean is shrunk to that of its neighbours as far as their differences
// are noise (Wiener): a pixel that found little would count too much if it were divided by itself, and one in a fine shadow
// too little if it were divided by its neighbours. What is left of the variance is added: the square's expectation.
class Brightness {
  public:
    Brightness(std::ptrdiff_t width, std::ptrdiff_t height, std::span<const float> known)
        : squares_(width, height), known_(known), count_(known.begin(), known.end()) {
        squares_.apply(count_, BrightnessRadius);
    }

    // `variance`: of the mean, finite.
    void estimate(std::span<const float> mean, std::span<const float> variance) {
        constexpr float Largest = 1e18f;  // its square is finite
        for (std::vector<float>* sum : {&value_, &others_, &sum_of_squares_, &noise_})
            sum->resize(mean.size());
        for (std::size_t i = 0; i < mean.size(); ++i) {
            const float value = known_[i] > 0.0f ? std::clamp(mean[i], -Largest, Largest) : 0.0f;
            value_[i] = others_[i] = value;
            sum_of_squares_[i] = value * value;
            noise_[i] = known_[i] * variance[i];
        }
        squares_.apply(others_, BrightnessRadius, Own::LeftOut);
        for (std::vector<float>* sum : {&sum_of_squares_, &noise_}) squares_.apply(*sum, BrightnessRadius);
        for (std::size_t i = 0; i < mean.size(); ++i) {
            if (known_[i] == 0.0f) continue;
            const float near = (others_[i] + value_[i]) / count_[i];
            // Two standard errors of the variance of so many normally distributed means are no difference.
            const float chance = 1.0f + 2.0f * std::sqrt(2.0f / count_[i]);
            const float differences =
                std::max(0.0f, (sum_of_squares_[i] - chance * noise_[i]) / count_[i] - near * near);
            const float own = differences > 0.0f ? differences / (differences + variance[i]) : 0.0f;
            const float others = count_[i] > 1.0f ? others_[i] / (count_[i] - 1.0f) : near;
            const auto square = [&](float prior) {
                const float value = prior + own * (value_[i] - prior);
                return value * value + own * variance[i];
            };
            others_[i] = square(others);
            value_[i] = square(near);
        }
    }
    // With and without the pixel among its neighbours.
    std::span<const float> of_all() const { return value_; }
    std::span<const float> of_others() const { return others_; }

  private:
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

}  // namespace

NoiseMap::NoiseMap(const frame::FilmTile& film) : deviations_(film.pixel_count(), 0.0f) {
    const std::uint32_t first = film.channels.first_plane(frame::Channel::Radiance);
    const std::size_t pixels = film.pixel_count();
    const float floor = floor_of(film, first);
    frame::DesignEffect design_effect;
    const std::span<const float> effects = design_effect.measure(film);
    SquareSum squares(film.rect.width, film.rect.height);
    std::vector<float> known(pixels);
    for (std::size_t i = 0; i < pixels; ++i) known[i] = film.counts[i] >= 2 ? 1.0f : 0.0f;
    Brightness brightness(film.rect.width, film.rect.height, known);
    std::vector<float> per_sample(pixels), variance(pixels), finds(pixels);
    double relative = 0.0, count = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        const std::span<const float> mean = film.plane(first + c), m2 = film.plane(first + 3 + c);
        for (std::size_t i = 0; i < pixels; ++i) {
            const float n = static_cast<float>(film.counts[i]);
            // Finite, so that one pixel does not make the whole picture infinite.
            variance[i] = known[i] > 0.0f ? std::min(m2[i] / ((n - 1.0f) * n) * effects[i], 1e30f) : 0.0f;
        }
        brightness.estimate(mean, variance);
        const std::span<const float> of_all = brightness.of_all(), of_others = brightness.of_others();
        for (std::size_t i = 0; i < pixels; ++i) {
            if (known[i] == 0.0f) continue;
            const float n = static_cast<float>(film.counts[i]);
            per_sample[i] += std::min(variance[i] * n / (of_all[i] + floor), 1e30f) / 3.0f;
            relative += double(std::min(variance[i] / (of_others[i] + floor), 1e30f)) / 3.0;
            // (sum x)^2 / sum x^2
            const double sum = double(n) * double(mean[i]);
            const double squares_sum = double(m2[i]) + sum * double(mean[i]);
            finds[i] += squares_sum > 0.0 ? static_cast<float>(sum * sum / squares_sum / 3.0) : 0.0f;
        }
    }
    for (std::size_t i = 0; i < pixels; ++i) {
        if (known[i] == 0.0f) continue;
        count += 1.0;
        deviations_[i] = std::sqrt(per_sample[i]);
    }
    if (count == 0.0) return;
    noise_ = std::sqrt(relative / count);
    squares.apply(deviations_, DeviationRadius);
    squares.apply(known, DeviationRadius);
    double excess = 0.0;
    for (std::size_t i = 0; i < pixels; ++i) {
        deviations_[i] /= std::max(known[i], 1.0f);
        if (film.counts[i] < 2) continue;
        const float beyond = per_sample[i] - deviations_[i] * deviations_[i];
        if (beyond > 0.0f) excess += double(beyond) / std::max(double(finds[i]), 1.0);
    }
    const auto rare = static_cast<float>(RareShare * excess / count);
    for (float& deviation : deviations_) deviation = std::sqrt(deviation * deviation + rare);
}

std::vector<float> noise_of_pixels(const frame::FilmTile& film) {
    std::vector<float> noise = NoiseMap(film).deviations();
    for (std::size_t i = 0; i < noise.size(); ++i)
        noise[i] = film.counts[i] < 2 ? 0.0f : noise[i] / std::sqrt(static_cast<float>(film.counts[i]));
    return noise;
}

}  // namespace tessera::picture

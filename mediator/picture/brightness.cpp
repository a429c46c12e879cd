#include "mediator/picture/brightness.h"

#include <algorithm>
#include <cmath>

#include "mediator/picture/color.h"

namespace tessera::picture {

namespace {

constexpr std::size_t BrightnessRadius = 2;

}  // namespace

void SquareSum::apply(std::span<float> values, std::size_t radius, Own own) {
    across_.resize(values.size());
    if (own == Own::LeftOut) across_others_.resize(values.size());
    for_bands(rows_.arena, rows_.height, PixelRows::BandRows, [&](std::size_t first, std::size_t last) {
        std::vector<float> padded(rows_.width + 2 * radius, 0.0f);
        for (std::size_t y = first; y < last; ++y) sum_row(values, y, radius, own, padded);
    });
    for_bands(rows_.arena, rows_.height, PixelRows::BandRows, [&](std::size_t first, std::size_t last) {
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

void SquareSum::sum_row(std::span<const float> values, std::size_t y, std::size_t radius, Own own,
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

Brightness::Brightness(const PixelRows& rows, std::span<const float> known)
    : rows_(rows), squares_(rows), known_(known), count_(known.begin(), known.end()) {
    squares_.apply(count_, BrightnessRadius);
}

void Brightness::estimate(std::span<const float> mean, std::span<const float> variance) {
    for (std::vector<float>* sum : {&value_, &others_, &sum_of_squares_, &noise_}) sum->resize(mean.size());
    rows_.each([&](std::size_t first, std::size_t last) {
        constexpr float Largest = 1e18f;  // its square is finite
        for (std::size_t i = first; i < last; ++i) {
            const float value = known_[i] > 0.0f ? std::clamp(mean[i], -Largest, Largest) : 0.0f;
            value_[i] = others_[i] = value;
            sum_of_squares_[i] = value * value;
            noise_[i] = known_[i] * variance[i];
        }
    });
    squares_.apply(others_, BrightnessRadius, SquareSum::Own::LeftOut);
    for (std::vector<float>* sum : {&sum_of_squares_, &noise_}) squares_.apply(*sum, BrightnessRadius);
    rows_.each([&](std::size_t first, std::size_t last) {
        for (std::size_t i = first; i < last; ++i) {
            if (known_[i] > 0.0f) shrink(i, variance[i]);
        }
    });
}

void Brightness::shrink(std::size_t i, float variance) {
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

float brightness_floor(const frame::FilmTile& film) {
    const std::uint32_t radiance = film.channels.first_plane(frame::Channel::Radiance);
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

}  // namespace tessera::picture

#include "mediator/picture/noise_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/frame/design_effect.h"
#include "mediator/picture/brightness.h"

namespace tessera::picture {

namespace {

constexpr std::size_t DeviationRadius = 4;
constexpr double RareShare = 1.0 / 8.0;

// Averages the deviations of pixels. `known`: 1 for those with two samples or more, `count` of them.
void average(const PixelRows& rows, const frame::FilmTile& film, std::vector<float>& known,
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
    const PixelRows rows{static_cast<std::size_t>(film.rect.width),
                         static_cast<std::size_t>(film.rect.height), arena};
    const std::uint32_t first_plane = film.channels.first_plane(frame::Channel::Radiance);
    const std::size_t pixels = film.pixel_count();
    const float floor = brightness_floor(film);
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

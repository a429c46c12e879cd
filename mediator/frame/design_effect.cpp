#include "mediator/frame/design_effect.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mediator/base/bands.h"

namespace tessera::frame {

namespace {

constexpr std::size_t Radius = 4, Rows = 2 * Radius + 1, BandRows = 64;

// Sums over pixels: errors of blocks and of their halves (merge.h), variance of the means of independent samples, and
// variance of the first of these, as it is and if samples were independent.
enum Term : std::size_t { Top, Below, Independent, Uncertainty, Chance, TermCount };

// One row, term after term, each with Radius zeros on either side; 0 where nothing is known.
void fill_row(const FilmTile& film, std::size_t y, std::size_t width, std::span<double> row) {
    constexpr std::array Weights{0.2126, 0.7152, 0.0722};  // as in merge.cpp
    const std::size_t padded = width + 2 * Radius;
    const std::uint32_t own = film.channels.first_plane(Channel::BlockVariance);
    const std::uint32_t m2 = film.channels.first_plane(Channel::Radiance) + 3;
    std::ranges::fill(row, 0.0);
    for (std::size_t x = 0; x < width; ++x) {
        const std::size_t i = y * width + x;
        if (film.counts[i] < 2) continue;
        const double n = film.counts[i], top = film.plane(own)[i], below = film.plane(own + 1)[i];
        double variance = 0.0;
        for (std::uint32_t c = 0; c < 3; ++c)
            variance += Weights[c] * double(film.plane(m2 + c)[i]) / (n * (n - 1.0));
        if (!std::isfinite(variance) || !std::isfinite(top) || !std::isfinite(below)) continue;
        double* terms = &row[Radius + x];
        terms[Top * padded] = top;
        terms[Below * padded] = below;
        terms[Independent * padded] = variance;
        // A squared difference of mean e that is normally distributed has the variance 2 e^2, and its square the mean
        // 3 e^2. Of n - 1 such differences `variance` is the mean, and this is one of them.
        const double share = (n - 2.0) / (n - 1.0);
        terms[Uncertainty * padded] = 2.0 / 3.0 * top * top * share;
        terms[Chance * padded] = 2.0 * variance * variance * share;
    }
}

// Sums over 2 Radius + 1 neighbours.
void pool_row(std::span<const double> padded, std::span<double> to) {
    std::ranges::fill(to, 0.0);
    for (std::size_t k = 0; k < Rows; ++k) {
        for (std::size_t x = 0; x < to.size(); ++x) to[x] += padded[x + k];
    }
}

// The deviation of the ratio from 1 is shrunk by its uncertainty (James and Stein 1961, positive part), so that noise alone
// makes no error smaller. It does not count within one standard deviation of what independent samples give by chance, and
// fully from sqrt(2) on: where one pixel has most of the variance, its finds may happen to be in both halves.
float effect(double top, double below, double independent, double uncertainty, double chance) {
    if (!(independent > 0.0)) return 1.0f;
    constexpr double Random = 2.0, Edge = 2.8284271247461903, Least = 1e-6;
    const double deviation = 1.0 - top / independent;
    if (!(deviation > 0.0)) return 1.0f;
    const double noise = uncertainty / (independent * independent);
    const double by_chance = std::max(chance / (independent * independent), 1e-30);
    const double significance = std::clamp(deviation * deviation / by_chance - 1.0, 0.0, 1.0);
    const double kept = significance * std::max(0.0, 1.0 - noise / (deviation * deviation));
    const double ratio = top > 0.0 ? std::clamp(below / top, Random, Edge) : Edge;
    const double growth = Random + (ratio - Random) * kept;
    return static_cast<float>(std::clamp((1.0 - deviation * kept) / std::sqrt(growth - 1.0), Least, 1.0));
}

}  // namespace

std::span<const float> DesignEffect::measure(const FilmTile& film, tbb::task_arena* arena) {
    effects_.assign(film.pixel_count(), 1.0f);
    const bool is_known =
        film.channels.contains(Channel::BlockVariance) && film.channels.contains(Channel::Radiance);
    const auto is_single = [](std::uint32_t n) { return n < 2; };
    if (!is_known || std::ranges::all_of(film.counts, is_single)) return effects_;
    const auto width = static_cast<std::size_t>(film.rect.width);
    const auto height = static_cast<std::size_t>(film.rect.height);
    // A band does 2 Radius rows again that belong to its neighbours.
    const std::size_t band = arena != nullptr ? BandRows : height;
    const std::size_t size = TermCount * ((Rows + 1) * width + width + 2 * Radius);
    scratch_.resize((height + band - 1) / band * size);
    for_bands(arena, height, band, [&](std::size_t first, std::size_t last) {
        measure_rows(film, first, last, std::span(scratch_).subspan(first / band * size, size));
    });
    return effects_;
}

void DesignEffect::measure_rows(const FilmTile& film, std::size_t first, std::size_t last,
                                std::span<double> scratch) {
    const auto width = static_cast<std::size_t>(film.rect.width);
    const auto height = static_cast<std::size_t>(film.rect.height);
    const std::size_t row_size = TermCount * width, padded = width + 2 * Radius;
    // The newest rows, pooled along x, one after another in a ring; their sum; one row.
    const std::span<double> sums = scratch.subspan(Rows * row_size, row_size);
    const std::span<double> row = scratch.subspan((Rows + 1) * row_size);
    for (std::size_t newest = first < Radius ? 0 : first - Radius; newest < last + Radius; ++newest) {
        if (newest < height) {
            fill_row(film, newest, width, row);
            for (std::size_t term = 0; term < TermCount; ++term)
                pool_row(row.subspan(term * padded, padded),
                         scratch.subspan((newest % Rows) * row_size + term * width, width));
        }
        if (newest < first + Radius) continue;
        const std::size_t y = newest - Radius;
        std::ranges::fill(sums, 0.0);
        for (std::size_t k = y < Radius ? 0 : y - Radius; k <= std::min(newest, height - 1); ++k) {
            const double* pooled = &scratch[(k % Rows) * row_size];
            for (std::size_t i = 0; i < row_size; ++i) sums[i] += pooled[i];
        }
        for (std::size_t x = 0; x < width; ++x) {
            effects_[y * width + x] =
                effect(sums[Top * width + x], sums[Below * width + x], sums[Independent * width + x],
                       sums[Uncertainty * width + x], sums[Chance * width + x]);
        }
    }
}

}  // namespace tessera::frame

#include "master/filter/svgf/fade_light.h"

#include <array>
#include <numeric>

#include "master/filter/svgf/edge_stops.h"

namespace tessera::filter::svgf {

namespace {

enum Term : std::uint32_t { Light, Difference, Gain, Distance, Spread, TermCount };
constexpr std::int64_t Radius =
    5;  // measured there: small squares follow edges of bias, large ones know w better

constexpr float Most = 1e30f;  // of a term, so that sums stay finite

void add(const float* from, std::size_t count, float* __restrict to) {
    for (std::size_t x = 0; x < count; ++x) to[x] += from[x];
}

// Eight sums side by side, in a fixed order.
double absolute_sum(const float* values, std::size_t count) {
    std::array<float, 8> sums{};
    std::size_t x = 0;
    for (; x + 8 <= count; x += 8) {
        for (std::size_t k = 0; k < 8; ++k) sums[k] += std::fabs(values[x + k]);
    }
    for (; x < count; ++x) sums[0] += std::fabs(values[x]);
    return std::accumulate(sums.begin(), sums.end(), 0.0);
}

void fill_terms(const float* light, const float* u, const float* v, const float* n, float floor,
                std::size_t count, float* __restrict difference, float* __restrict gain,
                float* __restrict distance) {
    for (std::size_t x = 0; x < count; ++x) {
        const float scale = (n[x] >= 2.0f ? 1.0f : 0.0f) / (std::fabs(light[x]) + floor);
        const float d = (light[x] - u[x]) * scale;
        difference[x] = d;
        const float deviation = std::sqrt(v[x] / std::max(n[x] - 1.0f, 1.0f)) * scale;
        gain[x] = std::min(deviation * deviation, Most);
        distance[x] = std::min(d * d, Most);
    }
}

// As in fade.h: half of the squared difference of neighbours, to the right and below.
void fill_spread(const float* here, const float* below, const float* n, const float* n_below,
                 std::size_t count, float* __restrict spread) {
    for (std::size_t x = 0; x < count; ++x) {
        const float own = here[x] * here[x], down = here[x] - below[x];
        const float part = n_below[x] >= 2.0f ? 0.5f * down * down : own;
        spread[x] = std::min(n[x] < 2.0f ? 0.0f : 0.5f * part, Most);
    }
    for (std::size_t x = 0; x + 1 < count; ++x) {
        const float own = here[x] * here[x], across = here[x] - here[x + 1];
        const float part = n[x + 1] >= 2.0f ? 0.5f * across * across : own;
        spread[x] += std::min(n[x] < 2.0f ? 0.0f : 0.5f * part, Most);
    }
    const std::size_t last = count - 1;
    spread[last] += std::min(n[last] < 2.0f ? 0.0f : 0.5f * here[last] * here[last], Most);
}

void divide(const float* gain, const float* distance, const float* spread, const float* n, std::size_t count,
            float* __restrict weight) {
    for (std::size_t x = 0; x < count; ++x) {
        const float known = std::min(gain[x], spread[x]);
        const float part = known / std::max(distance[x], Tiny);
        weight[x] = (n[x] < 2.0f) | (known >= distance[x]) ? 1.0f : part;
    }
}

}  // namespace

bool FadeLight::run(const Planes& film, const PaddedPlanes& filtered, RunContext& context) {
    const std::uint32_t width = film.width(), height = film.height();
    if (terms_.width() != width || terms_.height() != height) {
        terms_ = Planes(width, height, TermCount);
        weights_ = Planes(width, height, 1);
        row_sums_.assign(height, 0.0);
        no_samples_.assign(width, 0.0f);
    }
    if (!for_rows(context, height, [&](std::uint32_t y) {
            const float *r = filtered.row(0, y), *g = filtered.row(1, y), *b = filtered.row(2, y);
            float* __restrict light = terms_.row(Light, y);
            for (std::uint32_t x = 0; x < width; ++x) light[x] = luma(r[x], g[x], b[x]);
            row_sums_[y] = absolute_sum(light, width);
        })) {
        return false;
    }
    const double mean = std::accumulate(row_sums_.begin(), row_sums_.end(), 0.0) / double(film.pixel_count());
    const float floor = std::max(0.1f * static_cast<float>(mean), Tiny);
    if (!for_rows(context, height, [&](std::uint32_t y) {
            fill_terms(terms_.row(Light, y), film.row(MeanLuminance, y), film.row(SampleVariance, y),
                       film.row(Age, y), floor, width, terms_.row(Difference, y), terms_.row(Gain, y),
                       terms_.row(Distance, y));
        })) {
        return false;
    }
    if (!for_rows(context, height, [&](std::uint32_t y) {
            // The last row has nothing below: a count of 0 says so.
            const bool is_last = y + 1 == height;
            const float* n = film.row(Age, y);
            fill_spread(terms_.row(Difference, y), terms_.row(Difference, is_last ? y : y + 1), n,
                        is_last ? no_samples_.data() : film.row(Age, y + 1), width, terms_.row(Spread, y));
        })) {
        return false;
    }
    return for_rows(context, height, [&](std::uint32_t y) {
        constexpr std::size_t Chunk = 256;
        std::array<float, Chunk + 2 * Radius> columns_gain, columns_distance, columns_spread;
        std::array<float, Chunk> gain, distance, spread;
        const std::uint32_t top = y > Radius ? y - Radius : 0;
        const std::uint32_t bottom = std::min<std::uint32_t>(height - 1, y + Radius);
        for (std::uint32_t start = 0; start < width; start += Chunk) {
            const std::size_t count = std::min<std::size_t>(Chunk, width - start);
            const std::size_t left = std::min<std::size_t>(Radius, start);
            const std::size_t right = std::min<std::size_t>(Radius, width - start - count);
            columns_gain.fill(0.0f);
            columns_distance.fill(0.0f);
            columns_spread.fill(0.0f);
            for (std::uint32_t row = top; row <= bottom; ++row) {
                add(terms_.row(Gain, row) + start - left, count + left + right, &columns_gain[Radius - left]);
                add(terms_.row(Distance, row) + start - left, count + left + right,
                    &columns_distance[Radius - left]);
                add(terms_.row(Spread, row) + start - left, count + left + right,
                    &columns_spread[Radius - left]);
            }
            gain.fill(0.0f);
            distance.fill(0.0f);
            spread.fill(0.0f);
            for (std::size_t d = 0; d <= 2 * Radius; ++d) {
                add(&columns_gain[d], count, gain.data());
                add(&columns_distance[d], count, distance.data());
                add(&columns_spread[d], count, spread.data());
            }
            divide(gain.data(), distance.data(), spread.data(), film.row(Age, y) + start, count,
                   weights_.row(0, y) + start);
        }
    });
}

}  // namespace tessera::filter::svgf

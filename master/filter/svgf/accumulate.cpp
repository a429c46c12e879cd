#include "master/filter/svgf/accumulate.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <vector>

#include "master/filter/svgf/demodulate.h"

namespace tessera::filter::svgf {

namespace {

constexpr float SameLight = 1e-3f;  // relative differences that never count as a change

// The fraction that is kept at `z` deviations (Dundr 6.1).
float kept_at(float z, float z0) {
    return exp_negative(-std::max(0.0f, z - z0));
}

// By 3x3 pixels: the new mean against the old one, in deviations of their difference. Of row y; replaces `kept`.
void test_near(const Planes& history, const State& state, float z0, std::uint32_t y, float* kept) {
    const std::uint32_t width = history.width(), height = history.height();
    const std::uint32_t first_row = y > 0 ? y - 1 : 0, last_row = std::min(y + 1, height - 1);
    for (std::uint32_t x = 0; x < width; ++x) {
        const std::uint32_t first = x > 0 ? x - 1 : 0, last = std::min(x + 1, width - 1);
        float n = 0.0f, sum = 0.0f, squares = 0.0f, pixels = 0.0f;
        float age = 0.0f, old_sum = 0.0f, old_variance = 0.0f, known = 0.0f;
        for (std::uint32_t ty = first_row; ty <= last_row; ++ty) {
            const float* samples = state.moments.row(Age, ty);
            const float* light = state.moments.row(MeanLuminance, ty);
            const float* old_light = history.row(HistoryMoments + MeanLuminance, ty);
            const float* old_age = history.row(HistoryMoments + Age, ty);
            const float* variance = history.row(HistoryMoments + SampleVariance, ty);
            for (std::uint32_t tx = first; tx <= last; ++tx) {
                if (samples[tx] <= 0.0f || old_age[tx] <= 0.0f) continue;
                n += samples[tx];
                sum += samples[tx] * light[tx];
                squares += samples[tx] * light[tx] * light[tx];
                pixels += 1.0f;
                age += old_age[tx];
                old_sum += samples[tx] * old_light[tx];
                old_variance += variance[tx];
                known += 1.0f;
            }
        }
        kept[x] = 1.0f;
        if (n == 0.0f) continue;
        const float mean = sum / n, old_mean = old_sum / n;
        const float spread = std::max(0.0f, squares / n - mean * mean) / pixels;
        const float floor = SameLight * std::max(mean, old_mean);
        const float variance = spread + old_variance / known / age + floor * floor + 1e-30f;
        kept[x] = kept_at(std::fabs(mean - old_mean) / std::sqrt(variance), z0);
    }
}

// By 15x15 pixels: the mean of the differences against their spread. With one sample a pixel the light of a lamp is lost in
// the noise of 3x3 pixels, but not in that of 225: without this test, a fifth of it stayed.
class FarTest {
  public:
    explicit FarTest(std::uint32_t width) : columns_(Sums * (width + 2 * Radius)), sums_(Sums * width) {}

    // Of row y; lowers `kept`.
    void apply(const Planes& history, const State& state, float z0, std::uint32_t y, float* kept) {
        const std::uint32_t width = history.width();
        std::ranges::fill(columns_, 0.0f);
        const std::uint32_t first = y > Radius ? y - Radius : 0,
                            last = std::min(y + Radius, history.height() - 1);
        for (std::uint32_t row = first; row <= last; ++row) add_row(history, state, row);
        std::ranges::fill(sums_, 0.0f);
        for (std::uint32_t s = 0; s < Sums; ++s) {
            for (std::uint32_t k = 0; k <= 2 * Radius; ++k) {
                const float* from = column(s, width) + k;
                float* __restrict to = sum(s, width);
                for (std::uint32_t x = 0; x < width; ++x) to[x] += from[x];
            }
        }
        for (std::uint32_t x = 0; x < width; ++x) {
            const float pixels = sum(Pixels, width)[x], n = sum(Samples, width)[x];
            if (pixels < 2.0f) continue;
            const float mean = sum(Differences, width)[x] / n, floor = SameLight * sum(Light, width)[x] / n;
            const float spread = std::max(0.0f, sum(Squares, width)[x] / n - mean * mean) / (pixels - 1.0f);
            const float variance = spread + floor * floor + 1e-30f;
            kept[x] = std::min(kept[x], kept_at(std::fabs(mean) / std::sqrt(variance), z0));
        }
    }

  private:
    static constexpr std::uint32_t Radius = 7;
    enum Sum : std::uint32_t { Pixels, Samples, Differences, Squares, Light, Sums };

    float* column(std::uint32_t s, std::uint32_t width) {
        return &columns_[std::size_t{s} * (width + 2 * Radius)];
    }
    float* sum(std::uint32_t s, std::uint32_t width) { return &sums_[std::size_t{s} * width]; }

    void add_row(const Planes& history, const State& state, std::uint32_t y) {
        const std::uint32_t width = history.width();
        const float* samples = state.moments.row(Age, y);
        const float* light = state.moments.row(MeanLuminance, y);
        const float* old_light = history.row(HistoryMoments + MeanLuminance, y);
        const float* old_age = history.row(HistoryMoments + Age, y);
        float* pixels = column(Pixels, width) + Radius;
        float* ns = column(Samples, width) + Radius;
        float* differences = column(Differences, width) + Radius;
        float* squares = column(Squares, width) + Radius;
        float* lights = column(Light, width) + Radius;
#pragma GCC ivdep
        for (std::uint32_t x = 0; x < width; ++x) {
            const float n = old_age[x] > 0.0f ? samples[x] : 0.0f, difference = light[x] - old_light[x];
            pixels[x] += n > 0.0f ? 1.0f : 0.0f;
            ns[x] += n;
            differences[x] += n * difference;
            squares[x] += n * difference * difference;
            lights[x] += n * (light[x] > old_light[x] ? light[x] : old_light[x]);
        }
    }

    std::vector<float> columns_, sums_;  // of Sum: of rows, with margins; of squares
};

// The fraction of its age that history keeps where the light may have changed.
bool test_light(const Planes& history, const State& state, float z0, Planes& trust, RunContext& context) {
    const std::uint32_t width = history.width(), height = history.height();
    if (trust.width() != width || trust.height() != height) trust = Planes(width, height, 1);
    tbb::enumerable_thread_specific<FarTest> far([&] { return FarTest(width); });
    return for_rows(context, height, [&](std::uint32_t y) {
        float* kept = trust.row(0, y);
        test_near(history, state, z0, y, kept);
        far.local().apply(history, state, z0, y, kept);
    });
}

// One row, by the own weights.
void blend_colors(const Planes& history, const Albedos& albedos, std::uint32_t y, PaddedPlanes& color) {
    const std::size_t width = history.width();
    const float* own = color.row(OwnWeightComponent, y);
    for (std::uint32_t c = 0; c < 3; ++c) {
        float* __restrict to = color.row(c, y);
        const float* old = history.row(c, y);
        if (albedos.film == nullptr) {
            for (std::size_t x = 0; x < width; ++x) to[x] = own[x] * to[x] + (1.0f - own[x]) * old[x];
            continue;
        }
        const float *film = albedos.film->row(c, y), *before = albedos.history->row(c, y);
        for (std::size_t x = 0; x < width; ++x) {
            const float here = own[x] * std::max(film[x], LeastAlbedo);
            const float there = (1.0f - own[x]) * std::max(before[x], LeastAlbedo);
            const float part = here / (here + there);
            to[x] = part * to[x] + (1.0f - part) * old[x];
        }
    }
}

}  // namespace

bool accumulate(const Planes& history, const Accumulation& how, const Albedos& albedos, State& state,
                Planes& trust, RunContext& context) {
    const bool tested = how.z0 > 0.0f;
    if (tested && !test_light(history, state, how.z0, trust, context)) return false;
    const float keep = std::log1p(-how.r0);
    return for_rows(context, history.height(), [&](std::uint32_t y) {
        const std::size_t width = history.width();
        const float* trusted = tested ? trust.row(0, y) : nullptr;
        const float* old_age = history.row(HistoryMoments + Age, y);
        float* __restrict age = state.moments.row(Age, y);
        float* __restrict mean = state.moments.row(MeanLuminance, y);
        float* __restrict variance = state.moments.row(SampleVariance, y);
        const float* old_mean = history.row(HistoryMoments + MeanLuminance, y);
        const float* old_variance = history.row(HistoryMoments + SampleVariance, y);
        float* __restrict own = state.color.row(OwnWeightComponent, y);
        for (std::size_t x = 0; x < width; ++x) {
            const float old = old_age[x] * how.age_scale * (tested ? trusted[x] : 1.0f);
            const float n = age[x];
            const float weight = new_weight(n, old, keep);
            const float filled = old > 0.0f ? 0.0f : 1.0f;
            const float r = n > 0.0f ? (old > 0.0f ? weight : 1.0f) : filled;
            const float q = 1.0f - r;
            own[x] = r;
            age[x] = n > 0.0f ? std::min(n + old, n / r) : old;
            const float difference = mean[x] - old_mean[x];
            variance[x] = r * variance[x] + q * old_variance[x] + r * q * difference * difference;
            mean[x] = r * mean[x] + q * old_mean[x];
        }
        blend_colors(history, albedos, y, state.color);
    });
}

}  // namespace tessera::filter::svgf

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include "master/filter/pixel/gather.h"
#include "master/filter/pixel/plane_filters.h"
#include "master/filter/pixel/widths.h"

namespace tessera::filter::pixel {

namespace {

constexpr int Iterations = 3;
constexpr std::array<double, 5> Spline{1.0 / 16, 4.0 / 16, 6.0 / 16, 4.0 / 16, 1.0 / 16};

// Of the joint kernel of all iterations, whose steps are at most the 32 pixels of the parameter sigma_s.
constexpr std::size_t MaxJointTaps = 1 + 4 * Iterations * 32;

struct Steps {
    std::array<std::int64_t, Iterations> step;
    float correction;  // of the product of r in flat regions
};

// In one dimension: the sum of squares of the iterations' joint kernel over the product of their individual
// sums. In two dimensions it is squared.
Steps steps_of(float sigma) {
    Steps steps{};
    std::array<double, MaxJointTaps> joint{1.0};
    std::size_t taps = 1;
    double product = 1.0;
    const auto squares = [](const auto& weights) {
        double sum = 0.0;
        for (const double w : weights) sum += w * w;
        return sum;
    };
    for (int k = 0; k < Iterations; ++k) {
        const double wanted = iteration_sigma(sigma, Iterations - k, Iterations);
        const auto step = std::max<std::int64_t>(1, std::lround(wanted));
        steps.step[static_cast<std::size_t>(k)] = step;
        std::array<double, MaxJointTaps> wider{};
        const std::size_t wider_taps = taps + static_cast<std::size_t>(4 * step);
        assert(wider_taps <= MaxJointTaps);
        for (std::size_t tap = 0; tap < Spline.size(); ++tap) {
            for (std::size_t i = 0; i < taps; ++i) {
                wider[i + tap * static_cast<std::size_t>(step)] += Spline[tap] * joint[i];
            }
        }
        joint = wider;
        taps = wider_taps;
        product *= squares(Spline);
    }
    const double ratio = squares(joint) / product;
    steps.correction = static_cast<float>(ratio * ratio);
    return steps;
}

// -log2 of the spline's weights, relative to the centre's.
constexpr std::array<float, 3> Cost{0.0f, 0.584962501f, 2.584962501f};

template <std::size_t Features, std::size_t Layers>
bool iterate(const Guide& guide, Sources sources, std::int64_t step, const Field& from, Field& to,
             RunContext& context) {
    const auto width = static_cast<std::int64_t>(from.values.width());
    const auto height = static_cast<std::int64_t>(from.values.height());
    return for_rows(context, static_cast<std::uint32_t>(height), [&](std::uint32_t y) {
        for (std::int64_t x = 0; x < width; x += BlockWidth) {
            const auto target = target_of<Features>(guide, y, x);
            Sums<Layers> sums;
            for (std::int64_t v = -2; v <= 2; ++v) {
                const std::int64_t row = y + v * step;
                if (row < 0 || row >= height) continue;
                const auto near =
                    neighbourhood<Features, Layers>(guide, sources, from, static_cast<std::uint32_t>(row), x);
                for (std::int64_t u = -2; u <= 2; ++u) {
                    const std::int64_t at = u * step;
                    if (x + at < 1 - BlockWidth || x + at >= width) continue;
                    const float cost = Cost[static_cast<std::size_t>(std::abs(u))] +
                                       Cost[static_cast<std::size_t>(std::abs(v))];
                    add(near, target, all(cost), at, sums);
                }
            }
            const auto here = neighbourhood<Features, Layers>(guide, sources, from, y, x);
            keep_or_store(sums, here, normalised(sums), y, x, to);
        }
    });
}

}  // namespace

bool filter_atrous(const Guide& guide, float sigma, Field& field, Field& scratch, RunContext& context) {
    const Steps steps = steps_of(sigma);
    Sources sources = Sources::Samples;
    for (const std::int64_t step : steps.step) {
        const bool done = with_shapes(guide, field, [&](auto features, auto layers) {
            return iterate<features(), layers()>(guide, sources, step, field, scratch, context);
        });
        if (!done) return false;
        std::swap(field, scratch);
        sources = Sources::All;
    }
    return for_rows(context, field.values.height(), [&](std::uint32_t y) {
        float* reduction = field.reduction.row(0, y);
        for (std::uint32_t x = 0; x < field.values.width(); ++x) {
            reduction[x] = std::min(1.0f, reduction[x] * steps.correction);
        }
    });
}

}  // namespace tessera::filter::pixel

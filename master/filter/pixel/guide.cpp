#include "master/filter/pixel/guide.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera::filter::pixel {

namespace {

using frame::Channel;

// Depths in units of their tolerance: the largest of hits, and that of misses. Squares and their sums are
// finite.
constexpr float MostHit = 1e15f, Miss = 1e17f;
constexpr float MostColor = 1e15f;

// exp(-d^2 / (2 sigma^2)) = 2^-(scale d)^2.
float scale_of(float sigma) {
    return std::sqrt(0.5f * 1.44269504f) / std::max(sigma, 1e-12f);
}

// CIE 15:2004, with the white of linear sRGB, in hundredths.
void convert_to_lab(float* r, float* g, float* b, std::uint32_t width) {
    const auto f = [](float t) {
        constexpr float Linear = 216.0f / 24389.0f;
        return t > Linear ? std::cbrt(t) : (841.0f / 108.0f) * std::max(t, 0.0f) + 4.0f / 29.0f;
    };
    for (std::uint32_t x = 0; x < width; ++x) {
        const float fx = f(0.433953f * r[x] + 0.376219f * g[x] + 0.189828f * b[x]);
        const float fy = f(0.212671f * r[x] + 0.715160f * g[x] + 0.072169f * b[x]);
        const float fz = f(0.017758f * r[x] + 0.109477f * g[x] + 0.872765f * b[x]);
        r[x] = 1.16f * fy - 0.16f;
        g[x] = 5.0f * (fx - fy);
        b[x] = 2.0f * (fy - fz);
    }
}

constexpr std::int64_t Pad = 8;

void repeat_border(float* row, std::uint32_t width) {
    std::fill(row - Pad, row, row[0]);
    std::fill(row + width, row + width + Pad, row[width - 1]);
}

void isolate_border(float* row, std::uint32_t width) {
    std::fill(row - Pad, row, Guide::Nowhere);
    std::fill(row + width, row + width + Pad, Guide::Nowhere);
}

// For each of `count` indices the nearest i with has(i), ties to the lower one; `count` if there is none.
template <class Has, class Set>
void nearest(std::size_t count, const Has& has, const Set& set) {
    std::size_t before = count, behind = 0;
    for (std::size_t i = 0; i < count; ++i) {
        if (has(i)) before = i;
        if (behind <= i) {
            behind = i;
            while (behind < count && !has(behind)) ++behind;
        }
        const bool later = before == count || (behind < count && behind - i < i - before);
        set(i, later ? behind : before);
    }
}

}  // namespace

void Holes::find(const Inputs& inputs) {
    const std::span<const float> counts = inputs.counts.plane(0);
    any_ = std::ranges::any_of(counts, [](float n) { return !(n > 0.0f); });
    if (!any_) return;
    const std::size_t width = inputs.width, height = inputs.height;
    origin_.resize(width * height);
    const auto is_empty = [&](std::size_t y) {
        const auto row = counts.subspan(y * width, width);
        return std::ranges::none_of(row, [](float n) { return n > 0.0f; });
    };
    nearest(
        height, [&](std::size_t y) { return !is_empty(y); },
        [&](std::size_t y, std::size_t row) {
            nearest(
                width, [&](std::size_t x) { return row < height && counts[row * width + x] > 0.0f; },
                [&](std::size_t x, std::size_t column) {
                    const std::size_t from = row < height ? row * width + column : y * width + x;
                    origin_[y * width + x] = static_cast<std::uint32_t>(from);
                });
        });
}

void Guide::prepare(const Inputs& inputs, const Holes& holes, const Tolerance& tolerance,
                    RunContext& context) {
    const bool normals = tolerance.normal > 0.0f && inputs.has(Channel::Normal);
    features_.fit(inputs.width, inputs.height, normals ? 7 : 4);
    holes_ = holes.any();
    if (holes_) source_depth_.fit(inputs.width, inputs.height, 1);

    const auto fill = [&](std::uint32_t component, std::uint32_t y, std::span<const float> plane,
                          const auto& scaled) {
        float* to = features_.row(component, y);
        const std::size_t first = std::size_t{y} * inputs.width;
        if (plane.empty()) std::fill(to, to + inputs.width, 0.0f);
        for (std::size_t x = 0; x < inputs.width && !plane.empty(); ++x) to[x] = scaled(plane[first + x]);
        for (std::size_t x = 0; holes_ && x < inputs.width && !plane.empty(); ++x) {
            to[x] = scaled(plane[holes.origin(first + x)]);
        }
    };
    const auto component = [&](Channel channel, std::uint32_t c) {
        return inputs.has(channel) ? inputs.mean(channel).plane(c) : std::span<const float>();
    };
    for_rows(context, inputs.height, [&](std::uint32_t y) {
        const auto vector = [&](Channel channel, std::uint32_t first, float scale) {
            for (std::uint32_t c = 0; c < 3; ++c) {
                fill(first + c, y, component(channel, c), [scale](float value) {
                    return std::min(std::max(scale * value, -MostColor), MostColor);
                });
                repeat_border(features_.row(first + c, y), inputs.width);
            }
        };
        const bool lab = tolerance.metric == ColorMetric::Lab;
        vector(Channel::Headlight, 0, lab ? 1.0f : scale_of(tolerance.color));
        if (lab) {
            convert_to_lab(features_.row(0, y), features_.row(1, y), features_.row(2, y), inputs.width);
            for (std::uint32_t c = 0; c < 3; ++c) {
                float* row = features_.row(c, y);
                for (std::uint32_t x = 0; x < inputs.width; ++x) row[x] *= scale_of(tolerance.color);
                repeat_border(row, inputs.width);
            }
        }
        if (normals) vector(Channel::Normal, Depth + 1, scale_of(tolerance.normal));
        const float scale = scale_of(tolerance.depth);
        const bool relative = tolerance.depth_metric == DepthMetric::Relative;
        fill(Depth, y, component(Channel::Depth, 0), [scale, relative](float depth) {
            const float measured = relative ? std::log(std::max(depth, 1e-30f)) : depth;
            const float hit = std::min(scale * measured, MostHit);
            return depth < std::numeric_limits<float>::infinity() ? hit : Miss;
        });
        isolate_border(features_.row(Depth, y), inputs.width);
        if (!holes_) return;
        const float* depth = features_.row(Depth, y);
        float* source = source_depth_.row(0, y);
        for (std::size_t x = 0; x < inputs.width; ++x) {
            source[x] = inputs.counts.row(0, y)[x] > 0.0f ? depth[x] : Nowhere;
        }
        isolate_border(source, inputs.width);
    });
}

}  // namespace tessera::filter::pixel

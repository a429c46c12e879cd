#include "master/filter/nfor/regressors.h"

#include <algorithm>
#include <cmath>

namespace tessera::filter::nfor {

namespace {

using frame::Channel;

constexpr double MaxInverseDepth = 10.0;
constexpr PatchSettings Patches{.radius = 5, .patch = 1};

double mean_inverse_depth(const Planes& depth) {
    double sum = 0.0;
    std::size_t count = 0;
    for (const float z : depth.plane(0)) {
        if (!std::isfinite(z) || z <= 0.0f) continue;
        sum += 1.0 / z;
        ++count;
    }
    return count > 0 ? sum / static_cast<double>(count) : 1.0;
}

// The variance of the 3 x 3 pixels around each, over n.
void neighbourhood_variance(const Planes& values, const Planes& counts, std::uint32_t y, Planes& out) {
    const std::uint32_t width = values.width(), height = values.height();
    const std::uint32_t above = y > 0 ? y - 1 : y, below = std::min(y + 1, height - 1);
    for (std::uint32_t c = 0; c < values.components(); ++c) {
        const float* own = values.row(c, y);
        const float* n = counts.row(0, y);
        float* to = out.row(c, y);
        for (std::uint32_t x = 0; x < width; ++x) {
            const std::uint32_t left = x > 0 ? x - 1 : x, right = std::min(x + 1, width - 1);
            float sum = 0.0f, squares = 0.0f;
            for (const std::uint32_t row : {above, y, below}) {
                for (const std::uint32_t column : {left, x, right}) {
                    const float d = values.row(c, row)[column] - own[x];
                    sum += d;
                    squares += d * d;
                }
            }
            to[x] = std::max(squares / 9.0f - sum * sum / 81.0f, 0.0f) / std::max(n[x], 1.0f);
        }
    }
}

}  // namespace

void Regressors::gather(const Inputs& inputs, RunContext& context) {
    for (std::size_t group = 0; group < raw_.size(); ++group) shape(raw_[group], inputs, group < 2 ? 3 : 1);
    const Planes& depth = inputs.mean(Channel::Depth);
    const double scale = depth.empty() ? 1.0 : 1.0 / mean_inverse_depth(depth);
    for_rows(context, inputs.height, [&](std::uint32_t y) {
        const auto put = [&](Channel channel, Planes& planes) {
            for (std::uint32_t c = 0; inputs.has(channel) && c < 3; ++c) {
                std::copy_n(inputs.mean(channel).row(c, y), inputs.width, planes.row(c, y));
            }
        };
        put(Channel::Albedo, raw_[0]);
        put(Channel::Normal, raw_[1]);
        float* to = raw_[2].row(0, y);
        for (std::uint32_t x = 0; x < inputs.width; ++x) {
            const float z = depth.empty() ? INFINITY : depth.row(0, y)[x];
            const double inverse = std::isfinite(z) && z > 0.0f ? scale / z : 0.0;
            to[x] = static_cast<float>(std::min(inverse, MaxInverseDepth));
        }
    });
}

bool Regressors::prefilter(const Inputs& inputs, RunContext& context) {
    for (std::size_t group = 0; group < raw_.size(); ++group) {
        const Planes& raw = raw_[group];
        shape(variance_[group], inputs, raw.components());
        const bool done = for_rows(context, inputs.height,
                                   [&](std::uint32_t y) {
                                       neighbourhood_variance(raw, inputs.counts, y, variance_[group]);
                                   }) &&
                          nl_means_.run({raw, variance_[group], inputs.counts}, raw, Patches, 1.0f,
                                        smooth_[group], context);
        if (!done) return false;
    }
    return true;
}

}  // namespace tessera::filter::nfor

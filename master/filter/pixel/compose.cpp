#include "master/filter/pixel/compose.h"

#include <algorithm>

#include "master/filter/pixel/blend_factor.h"

namespace tessera::filter::pixel {

namespace {

// Pixels per chunk: their data stays in the first-level cache.
constexpr std::uint32_t Chunk = 256;

struct Pixels {
    std::uint32_t count;
    const float *n, *low[3], *filtered[3], *variance_of_one, *reduction;
    std::array<float, Chunk> variance, blend;
};

template <class Factor>
void weigh(Pixels& p, const Factor& factor) {
    for (std::uint32_t x = 0; x < p.count; ++x) {
        const float background = luminance(p.low[0][x], p.low[1][x], p.low[2][x]) +
                                 luminance(p.filtered[0][x], p.filtered[1][x], p.filtered[2][x]);
        p.variance[x] = p.variance_of_one[x] / std::max(p.n[x], 1.0f);
        const float s = factor(perceived_variance(p.variance[x], background), p.reduction[x]);
        p.blend[x] = p.n[x] < 2.0f ? 0.0f : s;
    }
}

void weigh_own(const Pixels& p, float* to) {
    for (std::uint32_t x = 0; x < p.count; ++x) {
        to[x] = p.blend[x] + (1.0f - p.blend[x]) * central_weight(p.reduction[x]);
    }
}

void mix(const Pixels& p, const float* radiance, const float* low, const float* unfiltered,
         const float* filtered, float clamp, float* to) {
    for (std::uint32_t x = 0; x < p.count; ++x) {
        const float s = p.blend[x];
        const float u = clamp > 0.0f ? clamp_spike(unfiltered[x], filtered[x], clamp) : unfiltered[x];
        const float mixed = low[x] + (s * u + (1.0f - s) * filtered[x]);
        to[x] = s < 1.0f ? mixed : radiance[x];
    }
}

}  // namespace

bool compose(const Inputs& inputs, const Light& light, const Field& filtered, const Blend& blend,
             Planes& picture, const BlendMaps& maps, RunContext& context) {
    const float t = blend.threshold;
    return for_rows(context, inputs.height, [&](std::uint32_t y) {
        for (std::uint32_t x = 0; x < inputs.width; x += Chunk) {
            Pixels p{.count = std::min(Chunk, inputs.width - x)};
            p.n = inputs.counts.row(0, y) + x;
            for (std::uint32_t c = 0; c < 3; ++c) {
                p.low[c] = light.low().row(c, y) + x;
                p.filtered[c] = filtered.values.row(c, y) + x;
            }
            p.variance_of_one = filtered.values.row(Field::Variance, y) + x;
            p.reduction = filtered.reduction.row(0, y) + x;
            if (blend.root == Root::Covariance) {
                weigh(p, [t](float u, float r) { return blend_factor(u, r * u, t, central_weight(r)); });
            } else {
                weigh(p, [t](float u, float r) { return blend_factor(u, r * u, t); });
            }
            for (std::uint32_t c = 0; c < 3; ++c) {
                mix(p, inputs.mean(frame::Channel::Radiance).row(c, y) + x, p.low[c],
                    light.high().row(c, y) + x, p.filtered[c], blend.spike_clamp, picture.row(c, y) + x);
            }
            if (picture.components() == 4) {
                const float* alpha = inputs.mean(frame::Channel::Alpha).row(0, y) + x;
                const float* smooth = filtered.values.row(Field::Alpha, y) + x;
                float* to = picture.row(3, y) + x;
                for (std::uint32_t i = 0; i < p.count; ++i) {
                    const float s = p.blend[i];
                    const float u = blend.spike_clamp > 0.0f
                                        ? clamp_spike(alpha[i], smooth[i], blend.spike_clamp)
                                        : alpha[i];
                    to[i] = s < 1.0f ? s * u + (1.0f - s) * smooth[i] : alpha[i];
                }
            }
            if (maps.self_weight) weigh_own(p, maps.self_weight->row(0, y) + x);
            if (maps.blend) std::copy_n(p.blend.data(), p.count, maps.blend->row(0, y) + x);
            if (maps.smoothed_variance) {
                std::copy_n(p.variance.data(), p.count, maps.smoothed_variance->row(0, y) + x);
            }
        }
    });
}

}  // namespace tessera::filter::pixel

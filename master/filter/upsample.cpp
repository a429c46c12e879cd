#include "master/filter/upsample.h"

#include <algorithm>
#include <array>

#include "master/filter/kernels.h"

namespace tessera::filter {

namespace {

using frame::Channel;

// Light per albedo: the offset keeps black surfaces finite and cancels where both albedos are equal.
constexpr float AlbedoOffset = 0.01f;
constexpr float SpatialSigma = 0.75f;  // in small pixels: neighbours blend, the second ring has little weight
constexpr float NormalSigma = 0.25f, AlbedoSigma = 0.2f;
constexpr float DepthSigma = 0.05f;   // relative
constexpr float LeastWeight = 1e-4f;  // below it only the spatial weights are used

struct Features {
    std::array<float, 3> albedo, normal;
    float depth;
};

Features at(const Inputs& inputs, std::size_t pixel) {
    Features f{};
    for (std::uint32_t c = 0; c < 3; ++c) {
        f.albedo[c] = inputs.mean(Channel::Albedo).plane(c)[pixel];
        f.normal[c] = inputs.mean(Channel::Normal).plane(c)[pixel];
    }
    f.depth = inputs.mean(Channel::Depth).plane(0)[pixel];
    return f;
}

float similarity(const Features& a, const Features& b) {
    const bool a_hit = std::isfinite(a.depth), b_hit = std::isfinite(b.depth);
    if (a_hit != b_hit) return 0.0f;
    if (!a_hit) return 1.0f;
    float albedo = 0.0f, normal = 0.0f;
    for (std::size_t c = 0; c < 3; ++c) {
        albedo += (a.albedo[c] - b.albedo[c]) * (a.albedo[c] - b.albedo[c]);
        normal += (a.normal[c] - b.normal[c]) * (a.normal[c] - b.normal[c]);
    }
    const float larger = std::max(std::fabs(a.depth), std::fabs(b.depth));
    const float depth = larger > 0.0f ? (a.depth - b.depth) / larger : 0.0f;
    return exp_negative(-0.5f * (albedo / (AlbedoSigma * AlbedoSigma) + normal / (NormalSigma * NormalSigma) +
                                 depth * depth / (DepthSigma * DepthSigma)));
}

}  // namespace

bool upsample(const Planes& picture, const Inputs& small, const Inputs& full, Planes& out,
              RunContext context) {
    const std::uint32_t components = picture.components();
    shape(out, full, components);
    const float scale_x = float(small.width) / float(full.width),
                scale_y = float(small.height) / float(full.height);
    const bool has_alpha = components == 4 && full.has(Channel::Alpha);
    return for_rows(context, full.height, [&](std::uint32_t y) {
        const float v = (float(y) + 0.5f) * scale_y - 0.5f;
        const auto y0 = static_cast<std::int32_t>(std::floor(v)) - 1;
        for (std::uint32_t x = 0; x < full.width; ++x) {
            const std::size_t here = std::size_t{y} * full.width + x;
            const float u = (float(x) + 0.5f) * scale_x - 0.5f;
            const auto x0 = static_cast<std::int32_t>(std::floor(u)) - 1;
            const Features own = at(full, here);
            const bool is_known = full.counts.plane(0)[here] > 0.0f;
            std::array<float, 4> similar{}, near{};
            float alike_weight = 0.0f, near_weight = 0.0f;
            for (std::int32_t j = y0; j < y0 + 4; ++j) {
                for (std::int32_t i = x0; i < x0 + 4; ++i) {
                    const auto sx = static_cast<std::size_t>(std::clamp(i, 0, std::int32_t(small.width) - 1));
                    const auto sy =
                        static_cast<std::size_t>(std::clamp(j, 0, std::int32_t(small.height) - 1));
                    const std::size_t there = sy * small.width + sx;
                    if (!(small.counts.plane(0)[there] > 0.0f)) continue;
                    const Features other = at(small, there);
                    const float dx = float(i) - u, dy = float(j) - v;
                    const float spatial =
                        exp_negative(-(dx * dx + dy * dy) / (2.0f * SpatialSigma * SpatialSigma));
                    const float weight = is_known ? spatial * similarity(own, other) : 0.0f;
                    for (std::uint32_t c = 0; c < components; ++c) {
                        const float value = picture.plane(c)[there];
                        const float factor =
                            c < 3 ? (own.albedo[c] + AlbedoOffset) / (other.albedo[c] + AlbedoOffset) : 1.0f;
                        similar[c] += weight * value * factor;
                        near[c] += spatial * value;
                    }
                    alike_weight += weight;
                    near_weight += spatial;
                }
            }
            const bool found = alike_weight > LeastWeight * near_weight;
            const float total = found ? alike_weight : near_weight;
            for (std::uint32_t c = 0; c < components; ++c) {
                const float sum = found ? similar[c] : near[c];
                out.plane(c)[here] = total > 0.0f ? sum / total : 0.0f;
            }
            if (has_alpha) out.plane(3)[here] = full.mean(Channel::Alpha).plane(0)[here];
        }
    });
}

}  // namespace tessera::filter

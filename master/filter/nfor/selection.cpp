#include "master/filter/nfor/selection.h"

#include <algorithm>
#include <cmath>

namespace tessera::filter::nfor {

namespace {

constexpr PatchSettings Patches{.radius = 5, .patch = 3};
constexpr float Largest = 1e30f;
// A hundredth of the squared mean of the picture, the floor of relMSE's denominator.
float floor_of(const std::array<std::array<Planes, 2>, 2>& filtered) {
    const std::span<const float> values = filtered[0][1].values().first(3 * filtered[0][1].pixel_count());
    double sum = 0.0;
    for (const float v : values) sum += std::abs(v);
    const double mean = sum / static_cast<double>(values.size());
    return std::clamp(static_cast<float>(0.01 * mean * mean), 1e-30f, Largest);
}

}  // namespace

bool Selection::run(const Inputs& inputs, const std::array<Half, 2>& halves,
                    const std::array<std::array<Planes, 2>, 2>& filtered, RunContext& context) {
    shape(guide_, inputs, 3);
    shape(variance_, inputs, 3);
    shape(advantage_, inputs, 1);
    shape(chosen_, inputs, 1);
    const std::uint32_t width = inputs.width;
    const float floor = floor_of(filtered);
    const bool gathered = for_rows(context, inputs.height, [&](std::uint32_t y) {
        float* advantage = advantage_.row(0, y);
        std::fill(advantage, advantage + width, 0.0f);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const std::size_t row = std::size_t{y} * width;
            const float* noisy[2] = {halves[0].colors[c].data() + row, halves[1].colors[c].data() + row};
            const float* narrow[2] = {filtered[0][0].row(c, y), filtered[1][0].row(c, y)};
            const float* wide[2] = {filtered[0][1].row(c, y), filtered[1][1].row(c, y)};
            float* guide = guide_.row(c, y);
            float* variance = variance_.row(c, y);
            for (std::uint32_t x = 0; x < width; ++x) {
                const float mean = 0.5f * (wide[0][x] + wide[1][x]), between = wide[0][x] - wide[1][x];
                guide[x] = mean;
                variance[x] = std::min(0.25f * between * between, Largest);
                const float relative = 1.0f / (std::min(mean * mean, Largest) + floor);
                for (int h = 0; h < 2; ++h) {
                    // (narrow - noisy)^2 - (wide - noisy)^2, with less rounding
                    const float worse = (narrow[h][x] - wide[h][x]) *
                                        (narrow[h][x] + wide[h][x] - 2.0f * noisy[1 - h][x]) * relative;
                    advantage[x] -= std::clamp(worse, -Largest, Largest);
                }
                // The mean of the halves has half the variance of one.
                const float spread = narrow[0][x] - narrow[1][x];
                const float noisier = 0.5f * (spread - between) * (spread + between) * relative;
                advantage[x] += std::clamp(noisier, -Largest, Largest);
            }
        }
    });
    const Guide guide{guide_, variance_, inputs.counts};
    if (!gathered || !nl_means_.run(guide, advantage_, Patches, 1.0f, smooth_, context)) return false;
    for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
        chosen_.plane(0)[i] = smooth_.plane(0)[i] > 0.0f ? 1.0f : 0.0f;
    }
    return nl_means_.run(guide, chosen_, Patches, 1.0f, first_, context);
}

}  // namespace tessera::filter::nfor

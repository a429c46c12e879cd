#include "master/filter/fdf/feature_bilateral.h"

#include <array>
#include <cmath>

#include "master/filter/kernels.h"
#include "master/filter/tiles.h"

namespace tessera::filter {

namespace {

using frame::Channel;

constexpr float Log2E = 1.44269504f;

// Background shading is moved to the other side of 0 by more than a weight of 2^-126.
constexpr float Apart = 128.0f;

// Planes of a row of the window, one after the other. Colours follow, times the count.
enum Window : std::uint32_t { Texture = 0, Normal = 3, Shading = 6, Count = 7, Color = 8 };

struct Layout {
    Layout(const Tile& tile, std::uint32_t radius, std::uint32_t components)
        : pitch((tile.width + 2 * radius + 2 * PackSize - 1) / PackSize * PackSize),
          rows(tile.height + 2 * radius),
          stride(std::size_t{pitch} * (Color + components)) {}
    std::uint32_t pitch, rows;
    std::size_t stride;
};

float divisor(float albedo) {
    return albedo > DemodulationFloor ? albedo : 1.0f;
}

void copy_features(const Inputs& inputs, const Planes& shading, const Planes& classes, const Tile& tile,
                   const FeatureSettings& settings, const Layout& layout, float* window) {
    const auto copy = [&](std::uint32_t plane, const auto& value) {
        copy_window(inputs.width, inputs.height, std::int64_t{tile.x} - settings.radius,
                    std::int64_t{tile.y} - settings.radius, layout.pitch, layout.rows,
                    window + std::size_t{plane} * layout.pitch, layout.stride, 0.0f,
                    [&](std::uint32_t y, std::uint32_t first, std::uint32_t last, float* to) {
                        const std::size_t row = std::size_t{y} * inputs.width;
                        for (std::uint32_t x = first; x < last; ++x) to[x - first] = value(row + x);
                    });
    };
    const auto copy_scaled = [&](std::uint32_t plane, std::span<const float> from, float scale) {
        const float* values = from.data();
        copy(plane, [=](std::size_t i) { return values[i] * scale; });
    };
    const float* counts = inputs.counts.plane(0).data();
    const float* kinds = classes.plane(0).data();
    const float* light = shading.plane(0).data();
    const Planes& albedo = inputs.mean(Channel::Albedo);
    const Planes& normal = inputs.mean(Channel::Normal);
    for (std::uint32_t c = 0; c < 3; ++c) {
        if (!albedo.empty()) copy_scaled(Texture + c, albedo.plane(c), Log2E / settings.t_max);
        if (!normal.empty()) copy_scaled(Normal + c, normal.plane(c), 0.5f * Log2E / settings.n_max);
    }
    constexpr auto Background = static_cast<float>(PixelClass::Background);
    const float scale = Log2E / settings.s_max;
    copy(Shading, [=](std::size_t i) {
        return kinds[i] == Background ? -Apart - light[i] * scale : light[i] * scale;
    });
    copy(Count, [=](std::size_t i) { return counts[i]; });
    for (std::uint32_t c = 0; c < inputs.color_components(); ++c) {
        const float* from = inputs.color(c).data();
        if (settings.demodulation == Demodulation::On && c < 3 && !albedo.empty()) {
            const float* surface = albedo.plane(c).data();
            copy(Color + c, [=](std::size_t i) { return counts[i] * from[i] / divisor(surface[i]); });
        } else {
            copy(Color + c, [=](std::size_t i) { return counts[i] * from[i]; });
        }
    }
}

// Sums of eight pixels over their windows: weights and colours.
template <std::uint32_t Components>
struct Sums {
    Pack weight, color[Components];
};

template <std::uint32_t Components>
Sums<Components> gather(const float* window, const Layout& layout, std::uint32_t radius, std::uint32_t x,
                        std::uint32_t y) {
    const std::size_t pitch = layout.pitch;
    const float* p = window + (y + radius) * layout.stride + x + radius;
    const Pack t0 = load(p), t1 = load(p + pitch), t2 = load(p + 2 * pitch);
    const Pack n0 = load(p + Normal * pitch), n1 = load(p + (Normal + 1) * pitch),
               n2 = load(p + (Normal + 2) * pitch);
    const Pack s = load(p + Shading * pitch), n = load(p + Count * pitch);
    Sums<Components> sums{};
    const float* row = window + y * layout.stride + x;
    for (std::uint32_t j = 0; j <= 2 * radius; ++j, row += layout.stride) {
        Sums<Components> line{};  // summed by lines, so that rounding grows with 17 + 17 terms and not 289
        const float* end = row + 2 * radius;
        for (const float* q = row; q <= end; ++q) {
            const Pack count = load(q + Count * pitch);
            Pack d = abs(s - load(q + Shading * pitch)) * min(n, count);
            d = max(max(d, abs(t0 - load(q))), max(abs(t1 - load(q + pitch)), abs(t2 - load(q + 2 * pitch))));
            d = max(max(d, abs(n0 - load(q + Normal * pitch))),
                    max(abs(n1 - load(q + (Normal + 1) * pitch)), abs(n2 - load(q + (Normal + 2) * pitch))));
            const Pack w = exp2_negative(d);
            line.weight += w * count;
            for (std::uint32_t c = 0; c < Components; ++c) {
                line.color[c] += w * load(q + (Color + c) * pitch);
            }
        }
        sums.weight += line.weight;
        for (std::uint32_t c = 0; c < Components; ++c) sums.color[c] += line.color[c];
    }
    return sums;
}

template <std::uint32_t Components>
void run_tile(const Inputs& inputs, const Tile& tile, const Layout& layout, const FeatureSettings& settings,
              const float* window, Planes& out, Planes& self_weight) {
    const bool demodulated = settings.demodulation == Demodulation::On && inputs.has(Channel::Albedo);
    for (std::uint32_t y = 0; y < tile.height; ++y) {
        const float* counts = inputs.counts.row(0, tile.y + y) + tile.x;
        for (std::uint32_t pack = 0; pack < tile.packs(); ++pack) {
            const Sums<Components> sums =
                gather<Components>(window, layout, settings.radius, pack * PackSize, y);
            const std::uint32_t first = pack * PackSize, last = std::min(tile.width, first + PackSize);
            for (std::uint32_t x = first; x < last; ++x) {
                const bool known = counts[x] > 0.0f;
                const float inverse = known ? 1.0f / sums.weight[x - first] : 0.0f;
                self_weight.row(0, tile.y + y)[tile.x + x] = counts[x] * inverse;
                for (std::uint32_t c = 0; c < Components; ++c) {
                    float value = sums.color[c][x - first] * inverse;
                    if (demodulated && c < 3) {
                        value *= divisor(inputs.mean(Channel::Albedo).row(c, tile.y + y)[tile.x + x]);
                    }
                    out.row(c, tile.y + y)[tile.x + x] = value;
                }
            }
        }
    }
}

}  // namespace

bool FeatureBilateral::run(const Inputs& inputs, const Planes& shading, const Planes& classes,
                           const FeatureSettings& settings, Planes& out, Planes& self_weight,
                           RunContext& context) {
    const std::uint32_t components = inputs.color_components();
    const Tiles tiles(inputs.width, inputs.height);
    return for_rows(context, tiles.count(), [&](std::uint32_t index) {
        const Tile tile = tiles.tile(index);
        const Layout layout(tile, settings.radius, components);
        std::vector<float>& window = scratch_.local();
        const std::size_t size = layout.stride * layout.rows + PackSize;
        if (window.size() < size) window.resize(size);
        std::ranges::fill(window, 0.0f);
        copy_features(inputs, shading, classes, tile, settings, layout, window.data());
        if (components == 4) {
            run_tile<4>(inputs, tile, layout, settings, window.data(), out, self_weight);
        } else {
            run_tile<3>(inputs, tile, layout, settings, window.data(), out, self_weight);
        }
    });
}

}  // namespace tessera::filter

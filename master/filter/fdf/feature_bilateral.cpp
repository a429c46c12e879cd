#include "master/filter/fdf/feature_bilateral.h"

#include <array>
#include <cmath>

#include "master/filter/kernels.h"
#include "master/filter/tiles.h"

namespace tessera::filter {

namespace {

using frame::Channel;

constexpr float Log2E = 1.44269504f;

// Background shading is shifted below 0 so far that weights across the boundary are 0 (exp2_negative).
constexpr float Apart = 128.0f;

// Planes of a row of the window, one after the other. Colours follow, times the count.
enum Window : std::uint32_t { Texture = 0, Normal = 3, Shading = 6, Count = 7, Color = 8 };

// Sized for the largest window, so that the planes of a pixel are at fixed offsets.
constexpr std::size_t Pitch = Tiles::Width + 2 * FeatureMaxRadius + PackSize;

constexpr std::size_t row_stride(std::uint32_t components) {
    return Pitch * (Color + components);
}

float divisor(float albedo) {
    return albedo > DemodulationFloor ? albedo : 1.0f;
}

// value(i) of each pixel i of the tile and its margin; 0 outside the picture.
template <class Value>
void copy_plane(const Inputs& inputs, const Tile& tile, const FeatureSettings& settings, float* window,
                std::uint32_t plane, const Value& value) {
    const std::uint32_t columns = tile.packs() * PackSize + 2 * settings.radius;
    const std::uint32_t rows = tile.height + 2 * settings.radius;
    copy_window(inputs.width, inputs.height, std::int64_t{tile.x} - settings.radius,
                std::int64_t{tile.y} - settings.radius, columns, rows, window + plane * Pitch,
                row_stride(inputs.color_components()), 0.0f,
                [&](std::uint32_t y, std::uint32_t first, std::uint32_t last, float* to) {
                    const std::size_t row = std::size_t{y} * inputs.width;
                    for (std::uint32_t x = first; x < last; ++x) to[x - first] = value(row + x);
                });
}

// Shading and colours, which are what a probe changes: light(i), and color(c)(i), of pixel i.
template <class Light, class Color>
void copy_samples(const Inputs& inputs, const Planes& classes, const Tile& tile,
                  const FeatureSettings& settings, float* window, const Light& light, const Color& color) {
    const float* counts = inputs.counts.plane(0).data();
    const float* kinds = classes.plane(0).data();
    constexpr auto Background = static_cast<float>(PixelClass::Background);
    const float scale = Log2E / settings.s_max;
    copy_plane(inputs, tile, settings, window, Shading, [=](std::size_t i) {
        return kinds[i] == Background ? -Apart - light(i) * scale : light(i) * scale;
    });
    const Planes& albedo = inputs.mean(Channel::Albedo);
    for (std::uint32_t c = 0; c < inputs.color_components(); ++c) {
        const auto value = color(c);
        if (settings.demodulation == Demodulation::On && c < 3 && !albedo.empty()) {
            const float* surface = albedo.plane(c).data();
            copy_plane(inputs, tile, settings, window, Window::Color + c,
                       [=](std::size_t i) { return counts[i] * value(i) / divisor(surface[i]); });
        } else {
            copy_plane(inputs, tile, settings, window, Window::Color + c,
                       [=](std::size_t i) { return counts[i] * value(i); });
        }
    }
}

void copy_features(const Inputs& inputs, const Planes& shading, const Planes& classes, const Tile& tile,
                   const FeatureSettings& settings, float* window) {
    const auto copy = [&](std::uint32_t plane, const auto& value) {
        copy_plane(inputs, tile, settings, window, plane, value);
    };
    const auto copy_scaled = [&](std::uint32_t plane, const Planes& from, std::uint32_t c, float scale) {
        if (from.empty()) return copy(plane, [](std::size_t) { return 0.0f; });
        const float* values = from.plane(c).data();
        copy(plane, [=](std::size_t i) { return values[i] * scale; });
    };
    const float* counts = inputs.counts.plane(0).data();
    const Planes& albedo = inputs.mean(Channel::Albedo);
    const Planes& normal = inputs.mean(Channel::Normal);
    for (std::uint32_t c = 0; c < 3; ++c) {
        copy_scaled(Texture + c, albedo, c, Log2E / settings.t_max);
        copy_scaled(Normal + c, normal, c, 0.5f * Log2E / settings.n_max);
    }
    copy(Count, [=](std::size_t i) { return counts[i]; });
    const float* light = shading.plane(0).data();
    copy_samples(
        inputs, classes, tile, settings, window, [light](std::size_t i) { return light[i]; },
        [&inputs](std::uint32_t c) {
            return [from = inputs.color(c).data()](std::size_t i) { return from[i]; };
        });
}

// Of eight pixels over their windows: the weight, then the colours.
template <std::uint32_t Components>
using Sums = std::array<Pack, Components + 1>;

// The sums of the eight pixels at (x, y), accumulated row by row, so that rounding grows with 17 + 17 terms
// and not with 289.
template <std::uint32_t Components>
Sums<Components> gather(const float* window, std::uint32_t radius, std::uint32_t x, std::uint32_t y) {
    constexpr std::size_t Stride = row_stride(Components);
    const float* p = window + (y + radius) * Stride + x + radius;
    const auto own = [p](std::uint32_t plane) { return load(p + plane * Pitch); };
    const Pack t0 = own(Texture), t1 = own(Texture + 1), t2 = own(Texture + 2);
    const Pack n0 = own(Normal), n1 = own(Normal + 1), n2 = own(Normal + 2);
    const Pack s = own(Shading), n = own(Count);
    Sums<Components> sums{};
    const float* row = window + y * Stride + x;
    for (std::uint32_t j = 0; j <= 2 * radius; ++j, row += Stride) {
        Sums<Components> line{};
        for (const float* q = row; q <= row + 2 * radius; ++q) {
            const auto distance = [q](Pack own_value, std::uint32_t plane) {
                return abs(own_value - load(q + plane * Pitch));
            };
            const Pack count = load(q + Count * Pitch);
            const Pack texture =
                max(max(distance(t0, Texture), distance(t1, Texture + 1)), distance(t2, Texture + 2));
            const Pack normal =
                max(max(distance(n0, Normal), distance(n1, Normal + 1)), distance(n2, Normal + 2));
            const Pack shading = distance(s, Shading) * min(n, count);
            const Pack w = exp2_negative(max(max(texture, normal), shading));
            line[0] += w * count;
            for (std::uint32_t c = 0; c < Components; ++c) {
                line[c + 1] += w * load(q + (Color + c) * Pitch);
            }
        }
        for (std::uint32_t i = 0; i <= Components; ++i) sums[i] += line[i];
    }
    return sums;
}

constexpr float ProbeStep = 0.25f;     // of a standard deviation
constexpr float MostResponse = 1e37f;  // so that sums stay finite

// Overwrites the window's colours and shading.
template <std::uint32_t Components>
void probe_tile(const Inputs& inputs, const Planes& shading, const Planes& classes, const Tile& tile,
                const FeatureSettings& settings, const Planes& picture, const Probe& probe, float* window) {
    const bool demodulated = settings.demodulation == Demodulation::On && inputs.has(Channel::Albedo);
    const Planes& variance = inputs.variance(Channel::Radiance);
    const float *light = shading.plane(0).data(), *moved = probe.shading.plane(0).data(),
                *signs = probe.signs.plane(0).data();
    copy_samples(
        inputs, classes, tile, settings, window,
        [=](std::size_t i) { return std::max(light[i] + ProbeStep * moved[i], 0.0f); },
        [&](std::uint32_t c) {
            const float *from = inputs.color(c).data(), *v = variance.plane(std::min(c, 2u)).data();
            const float step = c < 3 ? ProbeStep : 0.0f;
            return [=](std::size_t i) { return from[i] + step * signs[i] * std::sqrt(v[i]); };
        });
    for (std::uint32_t y = 0; y < tile.height; ++y) {
        float* const change = probe.change.row(0, tile.y + y) + tile.x;
        float* const response = probe.response.row(0, tile.y + y) + tile.x;
        std::fill_n(change, tile.width, 0.0f);
        std::fill_n(response, tile.width, 0.0f);
        if (y % ProbeSpacing != ProbeSpacing / 2) continue;
        const std::size_t row = std::size_t{tile.y + y} * inputs.width + tile.x;
        for (std::uint32_t x = y / ProbeSpacing % 2 * PackSize; x < tile.width; x += 2 * PackSize) {
            const Sums<Components> sums = gather<Components>(window, settings.radius, x, y);
            for (std::uint32_t i = x; i < std::min(x + PackSize, tile.width); ++i) {
                const std::size_t pixel = row + i;
                if (inputs.counts.plane(0)[pixel] < 2.0f) continue;
                for (std::uint32_t c = 0; c < 3; ++c) {
                    float value = sums[c + 1][i - x] / sums[0][i - x];
                    if (demodulated) value *= divisor(inputs.mean(Channel::Albedo).plane(c)[pixel]);
                    change[i] += signs[pixel] * std::sqrt(variance.plane(c)[pixel]);
                    response[i] += (value - picture.plane(c)[pixel]) / ProbeStep;
                }
                response[i] = std::max(-MostResponse, std::min(MostResponse, response[i]));
            }
        }
    }
}

template <std::uint32_t Components>
void run_tile(const Inputs& inputs, const Tile& tile, const FeatureSettings& settings, const float* window,
              Planes& out, Planes& self_weight) {
    const bool demodulated = settings.demodulation == Demodulation::On && inputs.has(Channel::Albedo);
    const auto put = [&](const Sums<Components>& sums, std::uint32_t x, std::uint32_t y) {
        const std::size_t pixel = std::size_t{tile.y + y} * inputs.width + tile.x + x;
        for (std::uint32_t i = 0; i < std::min(PackSize, tile.width - x); ++i) {
            const float count = inputs.counts.plane(0)[pixel + i];
            const float inverse = count > 0.0f ? 1.0f / sums[0][i] : 0.0f;
            self_weight.plane(0)[pixel + i] = count * inverse;
            for (std::uint32_t c = 0; c < Components; ++c) {
                float value = sums[c + 1][i] * inverse;
                if (demodulated && c < 3) {
                    value *= divisor(inputs.mean(Channel::Albedo).plane(c)[pixel + i]);
                }
                out.plane(c)[pixel + i] = value;
            }
        }
    };
    for (std::uint32_t y = 0; y < tile.height; ++y) {
        for (std::uint32_t x = 0; x < tile.width; x += PackSize) {
            put(gather<Components>(window, settings.radius, x, y), x, y);
        }
    }
}

}  // namespace

bool FeatureBilateral::run(const Inputs& inputs, const Planes& shading, const Planes& classes,
                           const FeatureSettings& settings, Planes& out, Planes& self_weight,
                           RunContext& context, const Probe* probe) {
    const std::uint32_t components = inputs.color_components();
    const Tiles tiles(inputs.width, inputs.height);
    scratch_.reserve(context, row_stride(components) * (Tiles::Height + 2 * FeatureMaxRadius) + PackSize);
    return for_rows(context, tiles.count(), [&](std::uint32_t index) {
        const Tile tile = tiles.tile(index);
        float* const window = scratch_.local();
        copy_features(inputs, shading, classes, tile, settings, window);
        if (components == 4) {
            run_tile<4>(inputs, tile, settings, window, out, self_weight);
            if (probe) probe_tile<4>(inputs, shading, classes, tile, settings, out, *probe, window);
        } else {
            run_tile<3>(inputs, tile, settings, window, out, self_weight);
            if (probe) probe_tile<3>(inputs, shading, classes, tile, settings, out, *probe, window);
        }
    });
}

}  // namespace tessera::filter

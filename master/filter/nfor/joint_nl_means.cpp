#include "master/filter/nfor/joint_nl_means.h"

#include <algorithm>

namespace tessera::filter::nfor {

namespace {

constexpr float Log2E = 1.44269504f;
constexpr std::size_t TileSize = std::size_t{Tiles::Width} * Tiles::Height;

}  // namespace

bool JointNlMeans::run(const Guide& guide, const Planes& values, const PatchSettings& settings, float k,
                       Planes& out, RunContext& context) {
    if (out.width() != values.width() || out.height() != values.height() ||
        out.components() != values.components()) {
        out = Planes(values.width(), values.height(), values.components());
    }
    const std::size_t window =
        (Tiles::Width + 2 * settings.radius + PackSize) * (Tiles::Height + 2 * settings.radius);
    slots_.reserve(context, [&](Slot& slot) {
        slot.distance.reserve(settings, guide.values.components());
        slot.distances.resize(TileSize);
        slot.window.resize(window * (MaxComponents + 1));
        slot.sums.resize(TileSize * (MaxComponents + 1));
    });
    const Tiles tiles(values.width(), values.height());
    return for_rows(context, tiles.count(), [&](std::uint32_t i) {
        run_tile(tiles.tile(i), guide, values, settings, k, out, slots_.local());
    });
}

void JointNlMeans::run_tile(const Tile& tile, const Guide& guide, const Planes& values,
                            const PatchSettings& settings, float k, Planes& out, Slot& slot) const {
    const std::uint32_t components = values.components();
    const auto radius = static_cast<std::int32_t>(settings.radius);
    const std::size_t columns = Tiles::Width + 2 * settings.radius + PackSize;
    const std::size_t rows = Tiles::Height + 2 * settings.radius, plane = columns * rows;
    slot.distance.load(guide, tile);
    std::ranges::fill(slot.sums, 0.0f);
    const auto copy = [&](std::uint32_t index, const auto& value) {
        copy_window(values.width(), values.height(), std::int64_t{tile.x} - radius,
                    std::int64_t{tile.y} - radius, static_cast<std::uint32_t>(columns),
                    static_cast<std::uint32_t>(rows), slot.window.data() + index * plane, columns, 0.0f,
                    [&](std::uint32_t y, std::uint32_t first, std::uint32_t last, float* to) {
                        for (std::uint32_t x = first; x < last; ++x) to[x - first] = value(y, x);
                    });
    };
    copy(0, [&](std::uint32_t y, std::uint32_t x) { return guide.known.row(0, y)[x] > 0.0f ? 1.0f : 0.0f; });
    for (std::uint32_t c = 0; c < components; ++c) {
        copy(1 + c, [&](std::uint32_t y, std::uint32_t x) { return values.row(c, y)[x]; });
    }
    const Pack scale = all(Log2E / (k * k));
    for (std::int32_t dy = -radius; dy <= radius; ++dy) {
        for (std::int32_t dx = -radius; dx <= radius; ++dx) {
            slot.distance.compute(dx, dy, 1, slot.distances.data());
            for (std::uint32_t y = 0; y < tile.height; ++y) {
                const float* distances = slot.distances.data() + y * Tiles::Width;
                const float* from =
                    slot.window.data() + (static_cast<std::size_t>(radius + dy) + y) * columns + radius + dx;
                float* to = slot.sums.data() + y * Tiles::Width;
                for (std::uint32_t x = 0; x < Tiles::Width; x += PackSize) {
                    const Pack w = exp2_negative(load(distances + x) * scale) * load(from + x);
                    store(to + x, load(to + x) + w);
                    for (std::uint32_t c = 1; c <= components; ++c) {
                        float* sum = to + c * TileSize + x;
                        store(sum, load(sum) + w * load(from + c * plane + x));
                    }
                }
            }
        }
    }
    for (std::uint32_t y = 0; y < tile.height; ++y) {
        const float* sums = slot.sums.data() + y * Tiles::Width;
        for (std::uint32_t c = 0; c < components; ++c) {
            const float* own = values.row(c, tile.y + y) + tile.x;
            float* to = out.row(c, tile.y + y) + tile.x;
            for (std::uint32_t x = 0; x < tile.width; ++x) {
                to[x] = sums[x] > 0.0f ? sums[(c + 1) * TileSize + x] / sums[x] : own[x];
            }
        }
    }
}

}  // namespace tessera::filter::nfor

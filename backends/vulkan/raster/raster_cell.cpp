#include "backends/vulkan/raster/raster_cell.h"

#include <algorithm>
#include <bit>

namespace tessera::vulkan {

std::uint32_t cell_edge(const shading::View& view) {
    return std::clamp(std::bit_ceil(std::max(view.width, view.height)), 64u, 2048u);
}

std::vector<CellPart> cells_of(const shading::View& view, const Rect& tile) {
    const auto edge = static_cast<std::int32_t>(cell_edge(view));
    std::vector<CellPart> parts;
    for (std::int32_t y = tile.y / edge * edge; y < tile.bottom(); y += edge) {
        for (std::int32_t x = tile.x / edge * edge; x < tile.right(); x += edge) {
            const Rect area = intersection(tile, {x, y, edge, edge});
            parts.push_back({static_cast<std::uint32_t>(x),
                             static_cast<std::uint32_t>(y),
                             {area.x - x, area.y - y, area.width, area.height}});
        }
    }
    return parts;
}

// Maps pixel p of the picture, at its subpixel position in this sample, to the centre of pixel p - x of the
// cell: the inverse of camera_ray().
shading::RasterCell make_cell(const shading::View& view, const CellPart& part, std::uint64_t index) {
    const std::uint32_t edge = cell_edge(view);
    const glm::vec2 offset = shading::filter_offset(view, shading::raster_place(view, index));
    const double size = edge;
    const auto scale = [&](float step) { return static_cast<float>(2.0 / (size * double(step))); };
    const auto shift = [&](std::uint32_t count, float moved, std::uint32_t first) {
        return static_cast<float>(2.0 * (0.5 * count - double(moved) - first) / size - 1.0);
    };
    return {.scale = {scale(view.step.x), scale(view.step.y)},
            .shift = {shift(view.width, offset.x, part.x), shift(view.height, offset.y, part.y)},
            .x = part.x,
            .y = part.y,
            .edge = edge,
            .unused = 0};
}

}  // namespace tessera::vulkan

#pragma once

#include <cstdint>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/shading/raster.h"

namespace tessera::vulkan {

// The picture is cut into square cells from its corner on, which depend on the picture's size alone: a pixel
// is drawn with the same numbers whatever tile it is asked for in.
struct CellPart {
    std::uint32_t x = 0, y = 0;  // of the cell's first pixel
    Rect area;                   // of the tile in it, from there
};

// Edge of the cells: a power of two that holds the picture, at most 2048, so that 8 bits below a pixel are
// left of a float's 24 with five to spare.
std::uint32_t cell_edge(const shading::View& view);

// Those that the tile, a part of the picture, touches.
std::vector<CellPart> cells_of(const shading::View& view, const Rect& tile);

shading::RasterCell make_cell(const shading::View& view, const CellPart& part, std::uint64_t index);

}  // namespace tessera::vulkan

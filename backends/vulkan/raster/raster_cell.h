#pragma once

#include <cstdint>
#include <vector>

#include "mediator/base/rect.h"
#include "mediator/shading/raster.h"

namespace tessera::vulkan {

// The picture is divided into square cells, depending only on the picture's size: a pixel is rasterised with
// the same numbers in whatever tile it is requested.
struct CellPart {
    std::uint32_t x = 0, y = 0;  // of the cell's first pixel
    Rect area;                   // of the tile in the cell, relative to that pixel
};

// Edge of the cells: a power of two that holds the picture, at most 2048, so that 8 bits below a pixel are
// left of a float's 24 with five to spare.
std::uint32_t cell_edge(const shading::View& view);

// The cells that overlap the tile.
std::vector<CellPart> cells_of(const shading::View& view, const Rect& tile);

shading::RasterCell make_cell(const shading::View& view, const CellPart& part, std::uint64_t index);

}  // namespace tessera::vulkan

#pragma once

#include "mediator/display/warp_map.h"

namespace tessera::display {

// The point at (u, v) of the picture, bilinear between nodes and extrapolated beyond the outermost.
glm::dvec3 point_at(const WarpMap& grid, double u, double v);

// The part of the picture between four nodes; border cells of a grid of pixel centres extend to the picture's
// edge.
struct GridCell {
    double left = 0, top = 0, right = 1, bottom = 1;  // in [0, 1] of the picture
};
std::uint32_t cell_columns(const WarpMap& grid);
std::uint32_t cell_rows(const WarpMap& grid);
GridCell cell(const WarpMap& grid, std::uint32_t column, std::uint32_t row);

}  // namespace tessera::display

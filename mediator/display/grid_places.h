#pragma once

#include "mediator/display/point_grid.h"

namespace tessera::display {

// The point of the place (u, v) of the picture, bilinear between nodes and carried on beyond the outermost.
glm::dvec3 point_at(const PointGrid& grid, double u, double v);

// The picture's places between four nodes; cells at the border of a grid of centres reach to the picture's
// edge.
struct GridCell {
    double left = 0, top = 0, right = 1, bottom = 1;  // in [0, 1] of the picture
};
std::uint32_t cell_columns(const PointGrid& grid);
std::uint32_t cell_rows(const PointGrid& grid);
GridCell cell(const PointGrid& grid, std::uint32_t column, std::uint32_t row);

}  // namespace tessera::display

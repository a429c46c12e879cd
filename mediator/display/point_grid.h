#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::display {

// Where the pixels of an output are seen, in display space, row by row from the top left. A point that is not
// finite is of a pixel that nobody sees.
struct PointGrid {
    std::uint32_t columns = 0, rows = 0;
    Grid::Nodes nodes = Grid::Nodes::Edges;
    std::vector<glm::dvec3> points;
    const glm::dvec3& at(std::uint32_t column, std::uint32_t row) const {
        return points[std::size_t{row} * columns + column];
    }
};

// The place (u, v) of the picture, from the top left, on the screen.
using PointAt = std::function<glm::dvec3(double u, double v)>;

// As few nodes as suffice: interpolated bilinearly they are nowhere off by more than a hundredth of a pixel
// (a smooth function is farthest from its interpolation in the middle between nodes; there it is measured).
// At most one node a pixel, on its centre, which is exact there.
PointGrid sample(const PointAt& point_at, std::uint32_t width, std::uint32_t height);

// The plane to render the points' view for: through their centroid, across the mean normal, on the side of
// the head. Throws Error{InvalidInput} when there are no points, when they make no surface, or when the head
// sees one of them at more than 80 degrees from the normal: the output must be split.
ViewPlane view_plane(const PointGrid& grid, const glm::dvec3& head);

// Of the points that are there, up to the picture's edges: their border, and some from within. At most 772,
// so a border of one radian on 4096 pixels is missed by less than half a pixel.
std::vector<glm::dvec3> hull(const PointGrid& grid);

// How large the view must be, for this head, so that half of the device's pixels are no finer than it.
struct Size {
    std::uint32_t width = 0, height = 0;
};
Size view_size(const PointGrid& grid, const ViewPlane& plane, const glm::dvec3& head, std::uint32_t width,
               std::uint32_t height);

}  // namespace tessera::display

#pragma once

#include <cstdint>
#include <functional>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::display {

// Where on the screen the pixels of an output are seen, in display space, row by row from the top left. Pixels whose
// point is not finite are not visible.
struct WarpMap {
    std::uint32_t columns = 0, rows = 0;
    Grid::Nodes nodes = Grid::Nodes::Edges;
    std::vector<glm::dvec3> points;
    const glm::dvec3& at(std::uint32_t column, std::uint32_t row) const {
        return points[std::size_t{row} * columns + column];
    }
};

// The point on the screen at (u, v) of the picture, from the top left.
using PointAt = std::function<glm::dvec3(double u, double v)>;

// Samples as few nodes as suffice for a bilinear interpolation error of at most a hundredth of a pixel (measured halfway
// between nodes, where the error of a smooth function is largest). At most one node per pixel, at its centre, which is
// exact there.
WarpMap sample(const PointAt& point_at, std::uint32_t width, std::uint32_t height);

// The projection plane for these points: through their centroid, perpendicular to the mean normal, facing the
// head. Throws Error{InvalidInput} when there are no points, when they do not form a surface, or when one
// of them is at more than 80 degrees from the normal as seen from the head: the output must be split.
ProjectionPlane projection_plane(const WarpMap& grid, const glm::dvec3& head);

// Of the finite points, up to the picture's edges: those of the border, and some inside. At most 772,
// so the error for a border of one radian on 4096 pixels is less than half a pixel.
std::vector<glm::dvec3> hull(const WarpMap& grid);

// The view size, for this head, such that half of the device's pixels are no finer than those of the view.
struct Size {
    std::uint32_t width = 0, height = 0;
};
Size view_size(const WarpMap& grid, const ProjectionPlane& plane, const glm::dvec3& head, std::uint32_t width,
               std::uint32_t height);

}  // namespace tessera::display

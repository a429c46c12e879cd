#include "mediator/display/warp_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <glm/geometric.hpp>
#include <numbers>

#include "mediator/base/error.h"
#include "mediator/display/warp_map_cells.h"

namespace tessera::display {

namespace {

using glm::dvec3;

constexpr double Tolerance = 0.005;  // pixels, in each direction: both together a hundredth
constexpr double MostDegrees = 80.0;
constexpr std::uint32_t BorderNodes = 129, InnerNodes = 16;

bool is_finite(const dvec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

WarpMap evaluated(const PointAt& point_at, std::uint32_t cells_across, std::uint32_t cells_down) {
    WarpMap grid{
        .columns = cells_across + 1, .rows = cells_down + 1, .nodes = Grid::Nodes::Edges, .points = {}};
    grid.points.reserve(std::size_t{grid.columns} * grid.rows);
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
        for (std::uint32_t column = 0; column < grid.columns; ++column)
            grid.points.push_back(point_at(double(column) / cells_across, double(row) / cells_down));
    }
    return grid;
}

WarpMap on_pixels(const PointAt& point_at, std::uint32_t width, std::uint32_t height) {
    WarpMap grid{.columns = width, .rows = height, .nodes = Grid::Nodes::Centres, .points = {}};
    grid.points.reserve(std::size_t{width} * height);
    for (std::uint32_t row = 0; row < height; ++row) {
        for (std::uint32_t column = 0; column < width; ++column)
            grid.points.push_back(point_at((column + 0.5) / width, (row + 0.5) / height));
    }
    return grid;
}

// Distance of `center` from the midpoint of `from` and `to`, in pixels: along the edge, which has `pixels` of
// them, and across it, where a pixel has the size `other`.
double off(const dvec3& from, const dvec3& center, const dvec3& to, double pixels, double other) {
    const dvec3 edge = to - from, deviation = center - 0.5 * (from + to);
    const double length = glm::length(edge);
    const double along = length > 0.0 ? std::abs(glm::dot(deviation, edge)) / length : 0.0;
    const double across = std::sqrt(std::max(0.0, glm::dot(deviation, deviation) - along * along));
    return (along > 0.0 ? along * pixels / length : 0.0) + (across > 0.0 ? across / other : 0.0);
}

// Every second node of `fine` would be kept; the others are compared with its interpolation.
std::array<double, 2> deviation(const WarpMap& fine, std::uint32_t width, std::uint32_t height) {
    const double pixels_across = 2.0 * width / (fine.columns - 1),
                 pixels_down = 2.0 * height / (fine.rows - 1);
    std::array<double, 2> most{0.0, 0.0};
    for (std::uint32_t row = 0; row + 2 < fine.rows; row += 2) {
        for (std::uint32_t column = 0; column + 2 < fine.columns; column += 2) {
            const dvec3 &a = fine.at(column, row), &b = fine.at(column + 2, row),
                        &c = fine.at(column, row + 2);
            const double pixel_across = glm::distance(a, b) / pixels_across;
            const double pixel_down = glm::distance(a, c) / pixels_down;
            most[0] = std::max(most[0], off(a, fine.at(column + 1, row), b, pixels_across, pixel_down));
            most[1] = std::max(most[1], off(a, fine.at(column, row + 1), c, pixels_down, pixel_across));
        }
    }
    return most;
}

// The corners of the cell to the right of and below a node, if all are finite.
struct Cell {
    dvec3 a, b, c, d;  // top left, top right, bottom left, bottom right
};

template <class Visit>
void for_each_cell(const WarpMap& grid, const Visit& visit) {
    for (std::uint32_t row = 0; row + 1 < grid.rows; ++row) {
        for (std::uint32_t column = 0; column + 1 < grid.columns; ++column) {
            const Cell cell{grid.at(column, row), grid.at(column + 1, row), grid.at(column, row + 1),
                            grid.at(column + 1, row + 1)};
            if (is_finite(cell.a) && is_finite(cell.b) && is_finite(cell.c) && is_finite(cell.d)) visit(cell);
        }
    }
}

// The most upright direction along the surface; on a floor that of the picture.
dvec3 upright(const dvec3& up_of_picture, const dvec3& normal) {
    const dvec3 up = glm::normalize(up_of_picture - glm::dot(up_of_picture, normal) * normal);
    const dvec3 side = glm::cross(up, normal);
    dvec3 best = up;
    for (const dvec3& candidate : {side, -side, -up}) {
        if (candidate.y > best.y + 1e-6) best = candidate;
    }
    return best;
}

std::vector<std::uint32_t> spread(std::uint32_t count, std::uint32_t most) {
    std::vector<std::uint32_t> indices;
    const std::uint32_t taken = std::min(count, most);
    for (std::uint32_t i = 0; i < taken; ++i)
        indices.push_back(taken > 1 ? std::uint32_t(std::uint64_t{i} * (count - 1) / (taken - 1)) : 0);
    return indices;
}

// Position of a node, or of the picture's edge for the outermost.
double place_on_edge(std::uint32_t index, std::uint32_t count, Grid::Nodes nodes) {
    if (index == 0) return 0.0;
    if (index + 1 == count) return 1.0;
    return nodes == Grid::Nodes::Edges ? double(index) / (count - 1) : (index + 0.5) / count;
}

void refuse_grazing(const WarpMap& grid, const dvec3& head, const dvec3& normal) {
    double least = 1.0;
    for (const dvec3& point : grid.points) {
        if (is_finite(point)) least = std::min(least, glm::dot(glm::normalize(head - point), normal));
    }
    const double degrees = std::acos(std::clamp(least, -1.0, 1.0)) * 180.0 / std::numbers::pi;
    if (degrees <= MostDegrees) return;
    char text[200];
    std::snprintf(
        text, sizeof text,
        "a point of it is %.0f degrees off the normal of its projection plane, more than %.0f: one flat "
        "view would be stretched; split the output, or move the head",
        degrees, MostDegrees);
    throw Error(ErrorCode::InvalidInput, text);
}

}  // namespace

WarpMap sample(const PointAt& point_at, std::uint32_t width, std::uint32_t height) {
    std::uint32_t across = 1, down = 1;
    while (across < width && down < height) {
        const std::array<double, 2> most =
            deviation(evaluated(point_at, 2 * across, 2 * down), width, height);
        // At least four cells per direction: the midpoint of an S curve is on the straight line.
        const bool is_coarse_across = across < 4 || most[0] > Tolerance;
        const bool is_coarse_down = down < 4 || most[1] > Tolerance;
        if (!is_coarse_across && !is_coarse_down) return evaluated(point_at, across, down);
        if (is_coarse_across) across *= 2;
        if (is_coarse_down) down *= 2;
    }
    return on_pixels(point_at, width, height);
}

std::vector<dvec3> hull(const WarpMap& grid) {
    std::vector<dvec3> points;
    // Nodes at pixel centres are extrapolated to the picture's edges.
    const auto take = [&](std::uint32_t column, std::uint32_t row) {
        const dvec3 point = grid.columns > 1 && grid.rows > 1
                                ? point_at(grid, place_on_edge(column, grid.columns, grid.nodes),
                                           place_on_edge(row, grid.rows, grid.nodes))
                                : grid.at(column, row);
        if (is_finite(point) || is_finite(grid.at(column, row)))
            points.push_back(is_finite(point) ? point : grid.at(column, row));
    };
    // The first and the last finite node of a line: others may be masked.
    const auto take_ends = [&](std::uint32_t count, const auto& is_there, const auto& take_one) {
        std::uint32_t first = 0, last = count;
        while (first < last && !is_there(first)) ++first;
        while (last > first && !is_there(last - 1)) --last;
        if (first == last) return;
        take_one(first);
        take_one(last - 1);
    };
    for (const std::uint32_t row : spread(grid.rows, BorderNodes)) {
        take_ends(
            grid.columns, [&](std::uint32_t column) { return is_finite(grid.at(column, row)); },
            [&](std::uint32_t column) { take(column, row); });
    }
    for (const std::uint32_t column : spread(grid.columns, BorderNodes)) {
        take_ends(
            grid.rows, [&](std::uint32_t row) { return is_finite(grid.at(column, row)); },
            [&](std::uint32_t row) { take(column, row); });
    }
    for (const std::uint32_t row : spread(grid.rows, InnerNodes)) {
        for (const std::uint32_t column : spread(grid.columns, InnerNodes)) take(column, row);
    }
    return points;
}

ProjectionPlane projection_plane(const WarpMap& grid, const dvec3& head) {
    dvec3 centroid{0.0}, normal{0.0}, up{0.0};
    double area = 0.0;
    for_each_cell(grid, [&](const Cell& cell) {
        const dvec3 facing = glm::cross(cell.b - cell.c, cell.a - cell.d);
        const double size = glm::length(facing);
        normal += facing;
        area += size;
        centroid += size * 0.25 * (cell.a + cell.b + cell.c + cell.d);
        up += cell.a + cell.b - cell.c - cell.d;
    });
    if (!(area > 0.0 && glm::length(normal) > 1e-6 * area && glm::length(up) > 0.0))
        throw Error(ErrorCode::InvalidInput, "its points do not form a surface: are they all on one line?");
    centroid /= area;
    normal = glm::normalize(normal);
    if (glm::dot(head - centroid, normal) < 0.0) normal = -normal;
    refuse_grazing(grid, head, normal);
    up = upright(up, normal);
    return {.origin = centroid, .right = glm::cross(up, normal), .up = up, .hull = hull(grid)};
}

Size view_size(const WarpMap& grid, const ProjectionPlane& plane, const dvec3& head, std::uint32_t width,
               std::uint32_t height) {
    const dvec3 normal = glm::cross(plane.right, plane.up);
    const auto seen = [&](const dvec3& point) {
        const dvec3 direction = point - head;
        return glm::dvec2(glm::dot(direction, plane.right), glm::dot(direction, plane.up)) /
               -glm::dot(direction, normal);
    };
    const bool on_edges = grid.nodes == Grid::Nodes::Edges;
    const double pixels = double(width) / (on_edges ? grid.columns - 1 : grid.columns) * double(height) /
                          (on_edges ? grid.rows - 1 : grid.rows);
    std::vector<double> areas;  // of one pixel
    for_each_cell(grid, [&](const Cell& cell) {
        const glm::dvec2 one = seen(cell.b) - seen(cell.c), two = seen(cell.a) - seen(cell.d);
        const double area = 0.5 * std::abs(one.x * two.y - one.y * two.x) / pixels;
        if (area > 0.0) areas.push_back(area);
    });
    if (areas.empty()) return {width, height};
    std::nth_element(areas.begin(), areas.begin() + std::ptrdiff_t(areas.size() / 2), areas.end());
    const double pitch = std::sqrt(areas[areas.size() / 2]);
    glm::dvec2 least(std::numeric_limits<double>::infinity()), most(-least);
    for (const dvec3& point : plane.hull) {
        least = glm::min(least, seen(point));
        most = glm::max(most, seen(point));
    }
    const auto edge = [&](double extent) {
        // A rounding error must not add a pixel.
        return std::uint32_t(std::clamp(std::ceil(extent / pitch - 1e-3), 1.0, double(MaxEdge)));
    };
    return {edge(most.x - least.x), edge(most.y - least.y)};
}

}  // namespace tessera::display

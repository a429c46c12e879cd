#include "mediator/display/warp_map_cells.h"

#include <algorithm>
#include <cmath>

namespace tessera::display {

namespace {

// The node before a position along one edge, and the fraction of the interval to the next.
struct Between {
    std::uint32_t node = 0;
    double fraction = 0.0;
};
Between between(double position, std::uint32_t nodes, Grid::Nodes where) {
    if (nodes < 2) return {};
    const double at = where == Grid::Nodes::Edges ? position * (nodes - 1) : position * nodes - 0.5;
    const double before = std::clamp(std::floor(at), 0.0, double(nodes - 2));
    return {std::uint32_t(before), at - before};
}

double node_position(std::uint32_t node, std::uint32_t nodes, Grid::Nodes where) {
    return where == Grid::Nodes::Edges ? double(node) / (nodes - 1) : (node + 0.5) / nodes;
}

std::uint32_t cells(std::uint32_t nodes) {
    return nodes > 1 ? nodes - 1 : 1;
}

// Where a cell begins and ends along one edge.
std::array<double, 2> cell_extent(std::uint32_t cell, std::uint32_t nodes, Grid::Nodes where) {
    return {cell == 0 ? 0.0 : node_position(cell, nodes, where),
            cell + 1 == cells(nodes) ? 1.0 : node_position(cell + 1, nodes, where)};
}

}  // namespace

glm::dvec3 point_at(const WarpMap& grid, double u, double v) {
    const Between across = between(u, grid.columns, grid.nodes), down = between(v, grid.rows, grid.nodes);
    const std::uint32_t right = std::min(across.node + 1, grid.columns - 1),
                        below = std::min(down.node + 1, grid.rows - 1);
    const auto mixed = [&](std::uint32_t row) {
        const glm::dvec3 &a = grid.at(across.node, row), &b = grid.at(right, row);
        return across.fraction == 0.0 ? a : a + across.fraction * (b - a);
    };
    const glm::dvec3 upper = mixed(down.node);
    return down.fraction == 0.0 ? upper : upper + down.fraction * (mixed(below) - upper);
}

std::uint32_t cell_columns(const WarpMap& grid) {
    return cells(grid.columns);
}

std::uint32_t cell_rows(const WarpMap& grid) {
    return cells(grid.rows);
}

GridCell cell(const WarpMap& grid, std::uint32_t column, std::uint32_t row) {
    const auto [left, right] = cell_extent(column, grid.columns, grid.nodes);
    const auto [top, bottom] = cell_extent(row, grid.rows, grid.nodes);
    return {left, top, right, bottom};
}

}  // namespace tessera::display

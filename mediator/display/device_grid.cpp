#include "mediator/display/device_grid.h"

#include <algorithm>
#include <cmath>

#include "mediator/base/error.h"
#include "mediator/display/turn.h"

namespace tessera::display {

DeviceGrid::DeviceGrid(const Grid& grid, const Output& output, const scene::BlobStore& arrays,
                       const std::string& what) {
    const std::size_t nodes = std::size_t{grid.columns} * grid.rows;
    const scene::BlobPtr blob = arrays.find(grid.values.hash);
    if (!blob)
        throw Error(ErrorCode::NotFound,
                    "the " + what + " of output '" + output.name + "' are missing: open the display again");
    const auto values = blob->as<float>();
    if (nodes == 0 || grid.components == 0 || values.size() != nodes * grid.components)
        throw Error(ErrorCode::InvalidInput, "the " + what + " of output '" + output.name + "' are " +
                                                 std::to_string(values.size()) + " numbers instead of " +
                                                 std::to_string(nodes * grid.components));
    const bool is_on_side = swaps_edges(output.turn);
    columns_ = is_on_side ? grid.rows : grid.columns;
    rows_ = is_on_side ? grid.columns : grid.rows;
    planes_.resize(grid.components);
    for (std::size_t c = 0; c < planes_.size(); ++c) {
        planes_[c].resize(nodes);
        for (std::size_t y = 0; y < rows_; ++y)
            for (std::size_t x = 0; x < columns_; ++x) {
                const PixelPosition from = upright_position(output.turn, {x, y}, columns_, rows_);
                planes_[c][y * columns_ + x] = values[(from.y * grid.columns + from.x) * grid.components + c];
            }
    }
    across_ = interpolation(output.width, columns_, grid.nodes);
    down_ = interpolation(output.height, rows_, grid.nodes);
}

DeviceGrid::Interpolation DeviceGrid::interpolation(std::size_t pixels, std::size_t nodes,
                                                    Grid::Nodes where) {
    Interpolation result{std::vector<std::uint32_t>(pixels, 0), std::vector<float>(pixels, 0.0f),
                         where == Grid::Nodes::Centres && pixels == nodes};
    for (std::size_t i = 0; i < pixels; ++i) {
        if (result.is_one_each) {
            result.nodes[i] = static_cast<std::uint32_t>(i);
        } else if (nodes > 1) {
            const double t = (static_cast<double>(i) + 0.5) / static_cast<double>(pixels);
            const double at = where == Grid::Nodes::Edges ? t * static_cast<double>(nodes - 1)
                                                          : t * static_cast<double>(nodes) - 0.5;
            const double before = std::clamp(std::floor(at), 0.0, static_cast<double>(nodes - 2));
            result.nodes[i] = static_cast<std::uint32_t>(before);
            result.fractions[i] = static_cast<float>(at - before);
        }
    }
    return result;
}

void DeviceGrid::row(std::size_t component, std::size_t y, float* out, float* space) const {
    const float* line = planes_[component].data() + down_.nodes[y] * columns_;
    if (const float fraction = down_.fractions[y]; fraction != 0.0f) {
        for (std::size_t x = 0; x < columns_; ++x)
            space[x] = line[x] + fraction * (line[x + columns_] - line[x]);
        line = space;
    }
    const std::size_t width = across_.nodes.size();
    if (across_.is_one_each || columns_ == 1) {
        const std::size_t step = columns_ == 1 ? 0 : 1;
        for (std::size_t x = 0; x < width; ++x) out[x] = line[step * x];
        return;
    }
    const std::uint32_t* nodes = across_.nodes.data();
    const float* fractions = across_.fractions.data();
    for (std::size_t x = 0; x < width; ++x) {
        const float* pair = line + nodes[x];
        out[x] = pair[0] + fractions[x] * (pair[1] - pair[0]);
    }
}

std::vector<float> DeviceGrid::all_pixels(std::size_t component) const {
    const std::size_t width = across_.nodes.size(), height = down_.nodes.size();
    std::vector<float> values(width * height), space(columns_);
    for (std::size_t y = 0; y < height; ++y) row(component, y, values.data() + y * width, space.data());
    return values;
}

}  // namespace tessera::display

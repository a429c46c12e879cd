#pragma once

#include <string>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::display {

// A grid's values at the centres of a device's pixels, bilinear in between and extrapolated linearly beyond
// the outermost nodes. Grids cover the upright picture; here they are rotated to the device's rows.
class DeviceGrid {
  public:
    DeviceGrid() = default;  // of no values
    // `what` names the grid in errors. Throws Error{NotFound} when the store lacks the values and
    // Error{InvalidInput} when their number does not match the grid.
    DeviceGrid(const Grid& grid, const Output& output, const scene::BlobStore& arrays,
               const std::string& what);

    bool empty() const { return planes_.empty(); }
    std::size_t columns() const { return columns_; }
    // One component along row y of the device: its width values into `out`. `space`: columns() floats.
    void row(std::size_t component, std::size_t y, float* out, float* space) const;
    std::vector<float> all_pixels(std::size_t component) const;  // width x height of the device

  private:
    // Positions of pixel centres between nodes.
    struct Interpolation {
        std::vector<std::uint32_t> nodes;  // the preceding node
        std::vector<float> fractions;      // of the interval to the next node
        bool is_one_each = false;          // pixel i is node i
    };
    static Interpolation interpolation(std::size_t pixels, std::size_t nodes, Grid::Nodes where);

    std::size_t columns_ = 0, rows_ = 0;
    std::vector<std::vector<float>> planes_;  // a component each
    Interpolation across_, down_;
};

}  // namespace tessera::display

#pragma once

#include <string>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::display {

// A grid's values at the centres of a device's pixels, bilinear in between and carried on linearly beyond the
// outermost nodes. Grids lie over the upright picture; here they are turned to the device's rows.
class DeviceGrid {
  public:
    DeviceGrid() = default;  // of no values
    // `what` names the grid in errors. Throws Error{NotFound} when the store lacks the values and
    // Error{InvalidInput} when there are more or fewer than the grid says.
    DeviceGrid(const Grid& grid, const Output& output, const scene::BlobStore& arrays,
               const std::string& what);

    bool empty() const { return planes_.empty(); }
    std::size_t columns() const { return columns_; }
    // One component along row y of the device: its width values into `out`. `space`: columns() floats.
    void row(std::size_t component, std::size_t y, float* out, float* space) const;
    std::vector<float> all_pixels(std::size_t component) const;  // width x height of the device

  private:
    // Where pixel centres lie between nodes.
    struct Places {
        std::vector<std::uint32_t> nodes;  // the one before
        std::vector<float> fractions;      // of the way to the next
        bool is_one_each = false;          // pixel i is node i
    };
    static Places places(std::size_t pixels, std::size_t nodes, Grid::Nodes where);

    std::size_t columns_ = 0, rows_ = 0;
    std::vector<std::vector<float>> planes_;  // a component each
    Places across_, down_;
};

}  // namespace tessera::display

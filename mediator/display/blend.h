#pragma once

#include <span>
#include <vector>

#include "mediator/display/device_grid.h"
#include "mediator/display/planar_row.h"

namespace tessera::display {

// The weight of a soft edge at t, from its start (0) to the full picture (1).
double soft_edge(double t, double shape);

// Soft edges and black level of one output, at the pixels of its device.
class BlendMap {
  public:
    // Throws as DeviceGrid does.
    BlendMap(const Output& output, const scene::BlobStore& arrays);

    bool changes_nothing() const { return weights_.empty() && across_.empty() && lift_.empty(); }
    // Value in [0, 1] -> lift + (1 - lift) x weight x value, along row y of the device.
    void apply(std::size_t y, PlanarRow row) const;
    double weight(std::size_t x, std::size_t y) const;

  private:
    std::size_t width_;
    std::vector<float> across_, down_;  // a weight is the product of two; empty: 1
    std::vector<float> weights_;        // a pixel each, instead
    std::vector<float> lift_;
};

}  // namespace tessera::display

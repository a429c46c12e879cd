#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mediator/display/device_grid.h"
#include "mediator/view/view.h"

namespace tessera::display {

// For each pixel of a device, its coordinates in an eye's picture: the pixel's point on the screen, projected from the
// eye onto the projection plane. Rows are computed on first use; different rows may be used by different threads
// concurrently.
class Warp {
  public:
    // `points` has three components and outlives this. A point up to half a pixel of the view beyond the
    // picture counts as its edge.
    Warp(const DeviceGrid& points, const Output& output);
    void set_frustum(const view::CameraPose& in_display);

    // In [0, 1] from the top left of the picture; NaN: the eye does not see the point there.
    struct Row {
        const float *u = nullptr, *v = nullptr;  // padded
    };
    // `space`: scratch memory of space_for() floats.
    Row row(std::size_t y, std::span<float> space);
    static std::size_t space_for(std::size_t width, const DeviceGrid& points) {
        return 3 * width + points.columns();
    }

  private:
    void make_row(std::size_t y, std::span<float> space);

    const DeviceGrid& points_;
    std::size_t width_, stride_;
    double margin_u_, margin_v_;
    view::CameraPose camera_;
    std::vector<float> u_, v_;
    std::vector<std::uint8_t> is_made_;  // a row each
};

}  // namespace tessera::display

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mediator/display/display.h"
#include "mediator/display/planar_row.h"

namespace tessera::display {

// From linear light to what a device is sent.
class DeviceColor {
  public:
    explicit DeviceColor(const Color& color);

    void apply_matrix(std::size_t count, PlanarRow row) const;  // and the gain

    // `count` pixels of row y, values outside [0, 1] cut off; not a number: 0. A value between two codes
    // becomes one or the other by an ordered pattern of 8 x 8 pixels, in such shares that their *light* has
    // the mean that was asked for (of a free curve: their codes): rounding to nearest would be off by several
    // percent in dark flat areas, and two projectors that overlap would each be off in their own way. A value
    // that is a code's is that code everywhere. `space` holds 3 x padded(count) + 8 bytes.
    void encode(std::size_t count, std::size_t y, PlanarRow row, std::uint8_t* space,
                std::uint8_t* rgb) const;
    // Device values in [0, 1], not rounded.
    void encode(std::size_t count, PlanarRow row, float* rgb) const;

    double device_value(double linear) const;  // of [0, 1]
    double light(double device_value) const;   // the inverse; of a curve the least that leads there

  private:
    double code_between(double linear, double tolerance) const;

    std::array<std::array<float, 3>, 3> matrix_;  // row by row
    bool has_matrix_;
    double gamma_;
    std::vector<float> curve_;
    // 256 x the code between two codes, of each half float in [0, 1].
    std::vector<std::uint16_t> table_;
};

}  // namespace tessera::display

#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mediator/display/display.h"
#include "mediator/display/planar_row.h"

namespace tessera::display {

// Converts linear light to device values.
class DeviceColor {
  public:
    explicit DeviceColor(const Color& color);

    void apply_matrix(std::size_t count, PlanarRow row) const;  // and the gain

    // `count` pixels of row y, clamped to [0, 1]; NaN: 0. A value between two codes is dithered between them with
    // an ordered 8 x 8 pattern, in proportions that preserve the mean *light* (for a free curve: the mean code).
    // Rounding to nearest would be off by several percent in dark flat areas, differently for each of two overlapping
    // projectors. A value that equals a code is that code everywhere. `space` holds 3 x padded(count) + 8 bytes.
    void encode(std::size_t count, std::size_t y, PlanarRow row, std::uint8_t* space,
                std::uint8_t* rgb) const;
    // Device values in [0, 1], not rounded.
    void encode(std::size_t count, PlanarRow row, float* rgb) const;

    double device_value(double linear) const;  // of [0, 1]
    double light(double device_value) const;   // the inverse; for a curve the smallest solution

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

#pragma once

#include <array>
#include <cstddef>

#include "mediator/display/display.h"
#include "mediator/display/planar_row.h"

namespace tessera::display {

// Averages pairs of neighbours: writes `count` means to `out` from pixel `first` on.
void halve_columns(PlanarRow row, std::size_t count, std::size_t first, PlanarRow out);

// `out` becomes the mean of both rows.
void average_rows(std::size_t count, PlanarRow row, PlanarRow out);

// Matrices from both eyes' colours to those of a red-cyan picture, in linear light, row by row.
struct EyeMix {
    std::array<std::array<float, 3>, 3> left, right;
};
const EyeMix& eye_mix(Stereo stereo);  // of AnaglyphPlain and AnaglyphDubois

// `right` becomes the mixed picture.
void mix_eyes(const EyeMix& mix, std::size_t count, PlanarRow left, PlanarRow right);

}  // namespace tessera::display

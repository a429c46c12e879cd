#pragma once

#include <cstdint>
#include <vector>

#include "mediator/display/surface.h"

namespace tessera::display {

// Columns x rows of outputs of the same size on one wall, whose corners are those of the outer pixels.
struct WallGrid {
    std::uint32_t columns = 1, rows = 1;
    std::uint32_t width = 1920, height = 1080;  // pixels of each output's picture
    // Metres between the pixels of neighbours (frames of monitors, which hide part of the picture), or pixels that
    // neighbours share (projectors). Not both.
    double bezel_across = 0.0, bezel_upward = 0.0;
    std::uint32_t overlap_across = 0, overlap_upward = 0;
};

// The part of the wall of each output, row by row from the top left. Throws Error{InvalidInput} when bezels
// or overlaps leave nothing.
std::vector<Part> parts(const Wall& wall, const WallGrid& grid);

}  // namespace tessera::display

#pragma once

#include <cstdint>

#include "mediator/display/planar_row.h"

namespace tessera::display {

// Linear red, green and blue of each pixel as half floats, rows from the top; at least two pixels wide.
struct HalfPicture {
    const std::uint16_t* values = nullptr;
    std::uint32_t width = 0, height = 0;
};

// Samples the picture at `count` positions, bilinear: u and v in [0, 1] from its top left; clamped to edge; NaN: black.
// u, v and the row are padded.
void sample_row(const HalfPicture& picture, const float* u, const float* v, std::size_t count, PlanarRow out);

// The same for positions in pixels of the picture; the first pixel's centre is (0, 0).
void sample_row_at(const HalfPicture& picture, const float* x, const float* y, std::size_t count,
                   PlanarRow out);

// Copies row y of the picture; the padding is not written.
void copy_row(const HalfPicture& picture, std::size_t y, PlanarRow out);

}  // namespace tessera::display

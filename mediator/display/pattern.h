#pragma once

#include "mediator/display/display.h"
#include "mediator/frame/image.h"

namespace tessera::display {

// The test pattern of an output, as an eye's picture of view_width x view_height in linear light; it goes
// through the output's pipeline like every picture. Shows border, grid, circle, name and size, ramps in steps
// of 8 bits (of sRGB: grey, red, green, blue, and the darkest 32 greys), and L or R for the eye.
//
// Grid lines are at multiples of a power of two metres along the projection plane's axes from its origin, so on
// flat screens the lines of outputs that share a wall coincide where the outputs overlap.
frame::Image pattern(const Output& output, view::Eye eye);

// The output without warp, soft edges and colour: for judging the device itself, pixel by pixel.
Output raw(const Output& output);

}  // namespace tessera::display

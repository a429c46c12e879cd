#pragma once

#include "client/display_file/section.h"
#include "mediator/display/display.h"

namespace tessera::display_file {

// The keys that an output, all outputs of a wall, and [[adjust]] have in common: x, y, stereo, turn,
// priority, blend, color. Sets those that are present.
void read_output_keys(Section& section, display::Output& output);

// Width and height of the output's picture as viewers see it.
struct Pixels {
    std::uint32_t width = 0, height = 0;
};
Pixels picture_size(const display::Output& output);

}  // namespace tessera::display_file

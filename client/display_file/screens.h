#pragma once

#include <optional>

#include "client/display_file/section.h"
#include "mediator/display/projector.h"
#include "mediator/display/surface.h"

namespace tessera::display_file {

// Whether the section defines a screen.
bool has_screen(const Section& section);

// From the keys of a flat screen (corners, or fov and distance), `cylinder` or `dome`. `aspect_ratio` is of
// the picture that a fov is for. Without any of these: straight ahead, 50 degrees high, 0.7 m away.
display::Screen read_screen(Section& section, double aspect_ratio);

// Only four corners.
display::Wall read_wall(Section& section);

// In display space.
view::CameraPose read_projector(Section& section, double aspect_ratio);

}  // namespace tessera::display_file

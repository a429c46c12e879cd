#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/display/display.h"
#include "mediator/display/point_grid.h"
#include "mediator/display/surface.h"
#include "mediator/view/view.h"

// Displays as people write them: docs/displays.md.
namespace tessera::display_file {

// What the display was made from: for plans, and for what people in front of the screens see.
struct OutputGeometry {
    std::string screen;                      // outputs with the same one share a screen; "" = one of its own
    std::optional<display::Screen> surface;  // nothing: only points are known
    std::optional<view::CameraPose> projector;  // in display space, when it is known
    display::PointGrid points;                  // of the device's pixels before any turn, u, v of its picture
};

struct DisplayFile {
    display::Display display;
    std::vector<OutputGeometry> geometry;  // one for each output
};

// The arrays that the display names are put into `blobs`. Files in it are relative to its folder. Throws
// Error{InvalidInput, NotFound, Io}: "FILE:LINE:COLUMN: output 'left': what is wrong and what to do". What
// it returns can be shown: every eye at rest is in front of every screen.
DisplayFile read_display(const std::string& path, scene::BlobStore& blobs);

// The same of a text that is said to stand in `path`.
DisplayFile parse_display(std::string_view text, const std::string& path, scene::BlobStore& blobs);

}  // namespace tessera::display_file

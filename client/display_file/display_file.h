#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mediator/base/error.h"
#include "mediator/display/display.h"
#include "mediator/display/surface.h"
#include "mediator/display/warp_map.h"
#include "mediator/view/view.h"

// Display files: docs/displays.md.
namespace tessera::display_file {

// The geometry that the display was computed from: for plans and the viewer preview.
struct OutputGeometry {
    std::string screen;                         // outputs with the same name share a screen; "" = not shared
    std::optional<display::Screen> surface;     // empty: only points are known
    std::optional<view::CameraPose> projector;  // in display space, if known
    display::WarpMap points;                    // of the device's pixels before any turn, u, v of its picture
};

struct DisplayFile {
    display::Display display;
    std::vector<OutputGeometry> geometry;  // one for each output
};

// Puts the display's arrays into `blobs`. Paths are relative to the display file's folder. Throws
// Error{InvalidInput, NotFound, Io}: "FILE:LINE:COLUMN: output 'left': cause and remedy". The returned display is
// valid: every eye of the head at rest is in front of every screen.
DisplayFile read_display(const std::string& path, scene::BlobStore& blobs);

// The same for a text; `path` is named in errors.
DisplayFile parse_display(std::string_view text, const std::string& path, scene::BlobStore& blobs);

}  // namespace tessera::display_file

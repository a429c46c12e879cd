#pragma once

#include "client/display_file/output_reader.h"

// Where an output's picture is seen: what of it the view, the plane and the points become. All throw
// Error{InvalidInput}, with the place in the file or without.
namespace tessera::display_file {

// The [[screen]] that the output names, or one that it has for itself.
void find_screen(Section& section, const ReadContext& context, double aspect_ratio, OutputGeometry& geometry);

// The picture lies flat on the part of the wall, pixel by pixel.
void lay_flat(const display::Wall& wall, const display::Part& part, ReadOutput& read);

// The picture's pixels are seen at the points of the geometry; on a wall, if it has one as its surface.
void lay_out(ReadOutput& read, ReadContext& context);

// The points where a projector's pixels meet the screen.
display::PointGrid thrown(const view::CameraPose& projector, const display::Screen& screen,
                          const display::Output& output);

}  // namespace tessera::display_file

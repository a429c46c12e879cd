#pragma once

#include "client/display_file/output_reader.h"

// Computes an output's view size, projection plane and points from its geometry. All throw Error{InvalidInput}, with or
// without the position in the file.
namespace tessera::display_file {

// The [[screen]] that the output names, or its own screen.
void find_screen(Section& section, const ReadContext& context, double aspect_ratio, OutputGeometry& geometry);

// For a flat picture that covers the part of the wall.
void lay_flat(const display::Wall& wall, const display::Part& part, ReadOutput& read);

// For pixels at the points of the geometry; projected onto its wall, if its surface is one.
void lay_out(ReadOutput& read, ReadContext& context);

// The points where a projector's pixels meet the screen.
display::WarpMap projected_points(const view::CameraPose& projector, const display::Screen& screen,
                                  const display::Output& output);

}  // namespace tessera::display_file

#pragma once

#include "client/display_file/display_file.h"
#include "client/tools/display/drawing.h"

namespace tessera::tools {

// A plan of a display, for checking measurements: from above, from the front, and from behind the head; with screens,
// outputs and their names, projectors, the head and its view.
Drawing plan(const display_file::DisplayFile& file);

}  // namespace tessera::tools

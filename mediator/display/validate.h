#pragma once

#include <string>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::display {

// The problems of a display, each naming the output and the remedy; empty = valid. Filter names and the contents of
// grids are checked where they are used.
std::vector<std::string> problems(const Display& display);

}  // namespace tessera::display

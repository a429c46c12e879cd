#pragma once

#include <string>
#include <vector>

#include "mediator/display/display.h"

namespace tessera::display {

// What is wrong with a display, one phrase each that names the output and the remedy; empty = it can be
// shown. Filter names and the contents of grids are looked at by who uses them.
std::vector<std::string> problems(const Display& display);

}  // namespace tessera::display

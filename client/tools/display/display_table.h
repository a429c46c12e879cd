#pragma once

#include <string>

#include "mediator/display/display.h"

namespace tessera::tools {

// For people: a line for each output with its sizes, eyes and bytes a frame, and what all need together.
std::string as_table(const display::Display& display);

}  // namespace tessera::tools

#pragma once

#include <string>

#include "mediator/display/display.h"

namespace tessera::tools {

// A table for users: a line per output with its sizes, eyes and bytes per frame, and the totals.
std::string as_table(const display::Display& display);

}  // namespace tessera::tools

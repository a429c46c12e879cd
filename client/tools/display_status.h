#pragma once

#include <string>

#include "mediator/wire/display_messages.h"

namespace tessera::tools {

std::string output_state_name(wire::OutputState state);  // "absent", "joining", "locked", "late"
void print_display(const wire::DisplayStatus& display);

}  // namespace tessera::tools

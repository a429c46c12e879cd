#pragma once

#include "mediator/session/status.h"

namespace tessera::tools {

void print_display(const session::DisplayStatus& display);

}  // namespace tessera::tools

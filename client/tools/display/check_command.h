#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display check
Command check_display_command(cli::CommandLine& display);

}  // namespace tessera::tools

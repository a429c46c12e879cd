#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display open
Command open_display_command(cli::CommandLine& display);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display adjust
Command adjust_display_command(cli::CommandLine& display);

}  // namespace tessera::tools

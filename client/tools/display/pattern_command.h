#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display pattern
Command pattern_command(cli::CommandLine& display);

}  // namespace tessera::tools

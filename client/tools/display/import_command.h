#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display import
Command import_command(cli::CommandLine& display);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display: displays described by files, with a sub-command for each operation.
Command display_command(cli::CommandLine& program);

}  // namespace tessera::tools

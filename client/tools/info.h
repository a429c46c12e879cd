#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera info: prints the contents of a scene file.
Command info_command(cli::CommandLine& program);

}  // namespace tessera::tools

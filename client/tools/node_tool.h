#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// "node release NAME", "node drain NAME": an operator's orders about nodes.
Command node_command(cli::CommandLine& program);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera log: who did what to a session's scene.
Command log_command(cli::CommandLine& program);

}  // namespace tessera::tools

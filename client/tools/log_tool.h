#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera log: lists the transactions of a recorded session.
Command log_command(cli::CommandLine& program);

}  // namespace tessera::tools

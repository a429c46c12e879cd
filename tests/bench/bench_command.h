#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench: measurements of what the program does, each a sub-command of its own.
Command bench_command(cli::CommandLine& program);

}  // namespace tessera::tools::bench

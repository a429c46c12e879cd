#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench: benchmarks, each a sub-command.
Command bench_command(cli::CommandLine& program);

}  // namespace tessera::tools::bench

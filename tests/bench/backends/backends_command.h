#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench backends: the speed of every back-end, beside the first one's in the same run.
Command backends_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

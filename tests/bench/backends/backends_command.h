#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench backends: the speed of every back-end, compared with the first one in the same run.
Command backends_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench adaptive: samples where they are needed against uniform ones.
Command adaptive_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

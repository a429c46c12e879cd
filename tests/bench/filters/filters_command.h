#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench filters: the error and the time of every filter on the same samples.
Command filters_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

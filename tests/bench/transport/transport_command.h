#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench transport: error of unfiltered pictures over samples and time.
Command transport_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

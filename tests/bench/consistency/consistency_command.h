#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench consistency: whether denoisers keep their promises, over several seeds.
Command consistency_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench variance: how true the film's variances of means are.
Command variance_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench variance: accuracy of the film's variances of means.
Command variance_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

Command displays_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

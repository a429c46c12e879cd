#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera filter: a saved film, filtered again.
Command filter_command(cli::CommandLine& program);

// tessera filters: which there are.
Command filters_command(cli::CommandLine& program);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera set-filter: changes the filter of a view that a cluster is rendering.
Command set_filter_command(cli::CommandLine& program);

}  // namespace tessera::tools

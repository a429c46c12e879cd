#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display: what stands in front of people, described in a file; each act on it a sub-command of its
// own.
Command display_command(cli::CommandLine& program);

}  // namespace tessera::tools

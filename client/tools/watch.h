#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// `tessera watch`: shows the frames of a live scene as they converge.
Command watch_command(cli::CommandLine& program);

}  // namespace tessera::tools

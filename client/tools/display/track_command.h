#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display track
Command track_command(cli::CommandLine& display);

}  // namespace tessera::tools

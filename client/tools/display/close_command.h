#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display close
Command close_display_command(cli::CommandLine& display);

}  // namespace tessera::tools

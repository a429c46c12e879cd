#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera display preview
Command viewer_preview_command(cli::CommandLine& display);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera render SCENE -o PICTURE…
Command render_command(cli::CommandLine& program);

// tessera coverage SCENE
Command coverage_command(cli::CommandLine& program);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera probe SCENE --pixel X,Y --sample I
Command probe_command(cli::CommandLine& program);

}  // namespace tessera::tools

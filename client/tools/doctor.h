#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera doctor
Command doctor_command(cli::CommandLine& program);

}  // namespace tessera::tools

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

Command jobs_command(cli::CommandLine& program);
Command fetch_command(cli::CommandLine& program);

}  // namespace tessera::tools

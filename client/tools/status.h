#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera status --master tcp://host:port
Command status_command(cli::CommandLine& program);

}  // namespace tessera::tools

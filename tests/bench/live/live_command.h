#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// `tessera bench live`: how soon edits are seen, and what many of them cost.
Command live_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

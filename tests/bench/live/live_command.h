#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// `tessera bench live`: latency of edits, and throughput of many of them.
Command live_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

#pragma once

#include "client/tools/command.h"

namespace tessera::tools::bench {

// tessera bench pictures: picture requests with a time budget, one after another, as a configurator sends
// them: how many are on time, how well the time was predicted, and how much better they are than unfiltered
// ones.
Command pictures_command(cli::CommandLine& bench);

}  // namespace tessera::tools::bench

#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// tessera filter: applies a filter to a saved film.
Command filter_command(cli::CommandLine& program);

// tessera filters: lists the filters.
Command filters_command(cli::CommandLine& program);

}  // namespace tessera::tools

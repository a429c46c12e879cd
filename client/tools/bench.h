#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// `tessera bench` is a separate program, tessera-bench, since it links measurement code that users do not need.

// Whether the first word of a command line is `bench`.
bool names_bench(int argc, const char* const* argv);

// Replaces this process by tessera-bench from the folder of this program, with the same arguments. Returns only on
// failure: prints the reason to standard error and returns the exit code.
int start_bench(char** argv);

// Adds `bench` to the commands, so that --help lists it.
Command bench_command(cli::CommandLine& program);

}  // namespace tessera::tools

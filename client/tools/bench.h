#pragma once

#include "client/tools/command.h"

namespace tessera::tools {

// `tessera bench` is a program of its own, tessera-bench: it measures, so it links what no user needs.

// Whether the first word of a command line is `bench`.
bool names_bench(int argc, const char* const* argv);

// Becomes tessera-bench, from the folder of this program, with the same words. Returns only when that fails: it says why on
// standard error and returns the exit code.
int start_bench(char** argv);

// `bench` among the commands, so that --help names it.
Command bench_command(cli::CommandLine& program);

}  // namespace tessera::tools

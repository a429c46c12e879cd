#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "client/tools/command.h"

namespace tessera::tools {

struct CompareOptions {
    std::string picture, reference;
    std::string layer;  // "" = R G B
    bool json = false;
    std::optional<double> max_relmse;
};

// Writes the differences of a picture from its reference to `out`. Returns 0, or ExitComparison when relmse
// is not within max_relmse. Throws Error for files that cannot be read or compared.
int run_compare(const CompareOptions& options, std::ostream& out);

// tessera compare
Command compare_command(cli::CommandLine& program);

}  // namespace tessera::tools

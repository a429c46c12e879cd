#pragma once

#include <iosfwd>
#include <string>

#include "client/tools/command.h"

namespace tessera::tools {

struct KeysOptions {
    std::string folder;
    std::string action = "create";  // create, add, list, revoke
    std::string name;               // of add and revoke
    std::string role;               // of add
    std::string export_file;        // of add: key file for the other machine
};

// Creates and manages the keys of a cluster. Prints what it did to `out`; failures go to standard error and are
// returned as exit code.
int run_keys(const KeysOptions& options, std::ostream& out);

// tessera keys
Command keys_command(cli::CommandLine& program);

}  // namespace tessera::tools

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
    std::string export_file;        // of add: what the other machine gets
};

// Makes and keeps the keys of a cluster. Says on `out` what it did; failures go to standard error and into
// the exit code.
int run_keys(const KeysOptions& options, std::ostream& out);

// tessera keys
Command keys_command(cli::CommandLine& program);

}  // namespace tessera::tools

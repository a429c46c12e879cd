#pragma once

#include <string>

#include "client/session.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

// --master, --keys and --user of commands that talk to a running cluster.
void add_cluster_options(cli::CommandLine& line, client::Address& address);

// Who this program is to a master, under the name given.
client::SessionSettings session_settings(const std::string& name);

}  // namespace tessera::tools

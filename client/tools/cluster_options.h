#pragma once

#include <stop_token>
#include <string>

#include "client/session.h"
#include "mediator/program/command_line.h"

namespace tessera::tools {

// --master, --keys and --user for commands that connect to a running cluster.
void add_cluster_options(cli::CommandLine& line, client::Address& address);

// The settings that identify this program to a master under the given name.
client::SessionSettings session_settings(const std::string& name, std::stop_token stop = {});

}  // namespace tessera::tools

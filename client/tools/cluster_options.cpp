#include "client/tools/cluster_options.h"

#include <unistd.h>

#include <iostream>

#include "client/tools/this_machine.h"

namespace tessera::tools {

void add_cluster_options(cli::CommandLine& line, client::Address& address) {
    line.option("--master", "where the cluster is: tcp://host:port", address.endpoint);
    line.option("--keys", "keys for that cluster: a folder, or an exported file", address.keys);
    line.option("--user", "whose pair in a folder of keys", address.user);
}

client::SessionSettings session_settings(const std::string& name) {
    return {.name = name,
            .host = host_name(),
            .software = "tessera " + cli::version(),
            .pid = static_cast<std::uint64_t>(::getpid()),
            .on_away = [name](bool is_away) {
                std::cerr << name
                          << (is_away ? ": the master does not answer: waiting for it to come back"
                                      : ": the master is back")
                          << std::endl;
            }};
}

}  // namespace tessera::tools

#include "client/tools/cluster_options.h"

#include <unistd.h>

#include <iostream>

#include "client/tools/host_info.h"

namespace tessera::tools {

void add_cluster_options(cli::CommandLine& line, client::Address& address) {
    line.option("--master", "endpoint of the cluster's master: tcp://host:port", address.endpoint);
    line.option("--keys", "keys for that cluster: a key folder or an exported key file", address.keys);
    line.option("--user", "name of the key to use from a key folder", address.user);
}

client::SessionSettings session_settings(const std::string& name, std::stop_token stop) {
    return {.name = name,
            .host = host_name(),
            .software = "tessera " + cli::version(),
            .pid = static_cast<std::uint64_t>(::getpid()),
            .stop = std::move(stop),
            .on_away = [name](bool is_away) {
                std::cerr << name
                          << (is_away ? ": lost the connection to the master: reconnecting"
                                      : ": reconnected to the master")
                          << std::endl;
            }};
}

}  // namespace tessera::tools

#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "mediator/base/clock.h"
#include "mediator/base/error.h"
#include "mediator/program/log.h"
#include "node/settings.h"

namespace tessera::node {

struct NodeOptions {
    std::string master;  // tcp://host:port
    std::string backend;
    std::string keys;           // a folder; "" only with `insecure`
    std::string user = "node";  // name of the key pair in that folder
    bool insecure = false;
    Drain drain = Drain::HandBack;
    std::uint32_t threads = 0;
    std::string isa, device;
    std::string cache;                                  // "" = none
    std::uint64_t cache_mib = 4096, memory_mib = 8192;  // of blobs, on disk and in memory
    std::string name, host;
    Duration simulated_cost{0};
    cli::LogSettings log{.program = "tessera-node"};
};

// Returns nothing to continue with `options`, else the exit code.
std::optional<int> parse_options(int argc, const char* const* argv, NodeOptions& options, std::ostream& out,
                                 std::ostream& err);

// "20us", "1.5ms", "2s", "300ns".
Expected<Duration> parse_duration(const std::string& text);

}  // namespace tessera::node

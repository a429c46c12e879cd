#pragma once

#include <iosfwd>
#include <optional>
#include <string>

#include "mediator/net/liveness.h"
#include "mediator/program/log.h"

namespace tessera::master {

struct MasterOptions {
    std::string listen = "tcp://127.0.0.1:7420";
    std::string keys;  // a folder; "" only with `insecure`
    bool insecure = false;
    double heartbeat_seconds = 1.0;
    std::uint64_t blob_quota_mib = 16384;  // per key
    std::string session;                   // folder; "" = live scenes end with the master
    double checkpoint_seconds = 10.0;
    double orphan_seconds = 600.0;
    std::uint64_t io_threads = 1;
    std::uint64_t memory_mib = 0;
    double verify_percent = 0.0;  // of the film of nodes
    std::uint32_t max_crashes = 2;
    cli::LogSettings log{.program = "tessera-master"};
};

// Returns nothing to continue with `options`, else the exit code.
std::optional<int> parse_options(int argc, const char* const* argv, MasterOptions& options, std::ostream& out,
                                 std::ostream& err);

}  // namespace tessera::master

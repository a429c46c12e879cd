#include "master/config.h"

#include <ostream>

#include "mediator/program/command_line.h"

namespace tessera::master {

namespace {

// What is wrong with the options; null: nothing.
const char* problem_of(const MasterOptions& options) {
    if (options.keys.empty() && !options.insecure) {
        return "no keys: give --keys DIR (make them with 'tessera keys DIR'), or --insecure on a loopback "
               "address";
    }
    if (!options.keys.empty() && options.insecure) return "--keys and --insecure exclude each other";
    if (!(options.heartbeat_seconds >= 0.05 && options.heartbeat_seconds <= 60.0)) {
        return "--heartbeat must be between 0.05 and 60 seconds";
    }
    if (!(options.checkpoint_seconds >= 0.1 && options.checkpoint_seconds <= 3600.0)) {
        return "--checkpoint must be between 0.1 and 3600 seconds";
    }
    if (options.io_threads < 1 || options.io_threads > 64) return "--io-threads must be between 1 and 64";
    if (options.memory_mib != 0 && options.memory_mib < 64) return "--memory must be at least 64 MiB";
    if (!(options.orphan_seconds >= 0.0 && options.orphan_seconds <= 1e6))
        return "--orphan must be between 0 and 1000000 seconds";
    if (!(options.verify_percent >= 0.0 && options.verify_percent <= 100.0))
        return "--verify must be between 0 and 100 percent";
    // After a single crash any of the node's samples may have been the cause.
    if (options.max_crashes < 2 || options.max_crashes > 1000)
        return "--max-crashes must be between 2 and 1000";
    return nullptr;
}

}  // namespace

std::optional<int> parse_options(int argc, const char* const* argv, MasterOptions& options, std::ostream& out,
                                 std::ostream& err) {
    cli::CommandLine line("tessera-master",
                          "Owns the scene and the picture; nodes and clients connect to it.");
    line.option("--listen", "where to listen: tcp://host:port; bulk data use the next port", options.listen);
    line.option("--keys", "folder of CURVE keys with the allow-list (made by: tessera keys DIR)",
                options.keys);
    line.flag("--insecure", "no encryption and no roles; only on a loopback address", options.insecure);
    line.option("--heartbeat", "seconds between heartbeats; a peer that misses three is removed",
                options.heartbeat_seconds);
    line.option("--blob-quota", "MiB of meshes and textures that the master holds for the clients of one key",
                options.blob_quota_mib);
    line.option(
        "--memory",
        "MiB for films, denoisers, meshes, textures and what waits to be sent; views and edits beyond it are "
        "refused (default: three quarters of this machine's)",
        options.memory_mib);
    line.option("--io-threads",
                "threads that encrypt and send; one does about 600 MB/s: more for many fast nodes",
                options.io_threads);
    line.option("--session",
                "folder that stores the live scene: edits, and checkpoints with the films; a "
                "master started with it resumes the session",
                options.session);
    line.option("--checkpoint", "seconds between checkpoints of the session", options.checkpoint_seconds);
    line.option("--orphan",
                "seconds a frame is rendered on, and its picture kept, after its client was lost "
                "(jobs of render --detach: until they are removed)",
                options.orphan_seconds);
    line.option("--verify",
                "percent of the units that another node of the same kind renders again, to compare the bits; "
                "a node that differs from two others is put into quarantine",
                options.verify_percent);
    line.option(
        "--max-crashes",
        "nodes that crash over the same samples before these are left out and the frame ends with the rest; "
        "raise it where machines may be taken away at any time",
        options.max_crashes);
    cli::add_log_options(line, options.log);
    line.examples({"tessera keys ~/.tessera && tessera-master --keys ~/.tessera",
                   "tessera-master --listen tcp://0.0.0.0:7420 --keys ~/.tessera",
                   "tessera-master --keys ~/.tessera --session /var/lib/tessera/room",
                   "tessera-master --insecure          # this machine only"});
    if (const auto exit = line.parse(argc, argv, out, err)) return exit;
    if (const char* problem = problem_of(options)) {
        err << "tessera-master: " << problem << "\n";
        return cli::ExitUsage;
    }
    return std::nullopt;
}

}  // namespace tessera::master

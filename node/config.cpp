#include "node/config.h"

#include <unistd.h>

#include <array>
#include <charconv>
#include <ostream>
#include <utility>

#include "mediator/backend/catalog.h"
#include "mediator/program/command_line.h"
#include "mediator/wire/peer_messages.h"

namespace tessera::node {

namespace {

std::string host_name() {
    std::array<char, 256> name{};
    return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

}  // namespace

Expected<Duration> parse_duration(const std::string& text) {
    constexpr std::array<std::pair<std::string_view, double>, 4> Units{
        {{"ns", 1.0}, {"us", 1e3}, {"ms", 1e6}, {"s", 1e9}}};
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    const std::string_view unit(end, static_cast<std::size_t>(text.data() + text.size() - end));
    for (const auto& [name, nanoseconds] : Units) {
        const double total = value * nanoseconds;
        if (error == std::errc{} && unit == name && total >= 0 && total < 1e15) {
            return Duration(static_cast<Duration::rep>(total));
        }
    }
    return failure(ErrorCode::InvalidInput,
                   "'" + text + "' is not a duration; write it like 20us, 1.5ms or 2s");
}

std::optional<int> parse_options(int argc, const char* const* argv, NodeOptions& options, std::ostream& out,
                                 std::ostream& err) {
    std::vector<std::string> backends;
    for (const backend::BackendEntry& entry : backend::catalog()) backends.push_back(entry.name);
    options.backend = backends.front();
    options.host = host_name();
    std::string cost = "0s", drain = "hand-back";

    cli::CommandLine line("tessera-node", "Renders for a master with one back-end.");
    line.option("--master", "the master's address: tcp://host:port", options.master);
    line.choice("--backend", "rendering back-end", options.backend, backends);
    line.option("--keys", "folder with this node's CURVE pair and the master's public key", options.keys);
    line.option("--user", "name of the key pair in that folder", options.user);
    line.flag("--insecure", "no encryption; only to a master on this machine", options.insecure);
    line.option("--threads", "units rendered at a time; 0 = one per core", options.threads);
    line.choice("--isa", "instruction set of the back-end; avx2 gives the same bits on every node",
                options.isa, {"avx2", "avx512"});
    if (backend::has_device_choice()) {
        line.option("--device", "index or part of a name, as tessera doctor lists them; default: the best",
                    options.device);
    }
    line.option("--cache", "keep blobs, built trees and kernels in this folder, for the next start",
                options.cache);
    line.option("--cache-size", "MiB of blobs that the cache folder may hold; all other caches may hold 320",
                options.cache_mib);
    line.option("--memory", "MiB of blobs in memory; above it unused ones are dropped", options.memory_mib);
    line.option("--name", "name of this node in logs and status; default: the host's name", options.name);
    line.choice(
        "--drain",
        "when it is asked to stop: hand-back sends the samples rendered so far within 3 s, finish renders "
        "its units to the end first",
        drain, {"hand-back", "finish"});
    line.option("--simulate-cost", "back-end null only: time per sample of a pixel, like 20us", cost);
    cli::add_log_options(line, options.log);
    line.required("--master");
    line.examples(
        {"tessera-node --master tcp://10.0.0.5:7420 --keys ~/node-keys",
         "tessera-node --master tcp://127.0.0.1:7420 --insecure --threads 2",
         "tessera-node --config node.toml --cache /var/cache/tessera",
         "tessera-node --master tcp://127.0.0.1:7420 --insecure --backend null --simulate-cost 20us"});
    if (const auto exit = line.parse(argc, argv, out, err)) return exit;

    const auto usage = [&](const std::string& text) {
        err << "tessera-node: " << text << "\n";
        return cli::ExitUsage;
    };
    if (!options.master.starts_with("tcp://")) {
        return usage("'" + options.master + "' is not an address; write it like tcp://127.0.0.1:7420");
    }
    if (options.keys.empty() && !options.insecure) {
        return usage(
            "no keys: give --keys DIR (made by 'tessera keys'), or --insecure for a master on this machine");
    }
    if (!options.keys.empty() && options.insecure) return usage("--keys and --insecure exclude each other");
    if (const auto fine = backend::check_device(backend::find_backend(options.backend), options.device);
        !fine) {
        return usage(fine.error().what());
    }
    if (drain == "finish") options.drain = Drain::Finish;
    const Expected<Duration> simulated = parse_duration(cost);
    if (!simulated) return usage(std::string("--simulate-cost: ") + simulated.error().what());
    options.simulated_cost = *simulated;
    if (options.name.empty()) options.name = options.host;
    if (options.name.size() > wire::MaxNameBytes)
        return usage("--name is longer than " + std::to_string(wire::MaxNameBytes) + " bytes");
    if (options.threads > wire::MaxConcurrentUnits)
        return usage("--threads is more than " + std::to_string(wire::MaxConcurrentUnits));
    return std::nullopt;
}

}  // namespace tessera::node

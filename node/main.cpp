#include <unistd.h>

#include <iostream>
#include <new>
#include <stop_token>

#include "mediator/backend/catalog.h"
#include "mediator/base/malloc_trim.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/program/command_line.h"
#include "mediator/program/crash_report.h"
#include "mediator/program/signals.h"
#include "node/config.h"
#include "node/render_node.h"

namespace {

using namespace tessera;

void log_report(const cli::Log& log, const node::Report& report) {
    if (report.is_detail) return log.debug(report.text, report.about);
    switch (report.severity) {
        case wire::Severity::Info:
            return log.info(report.text, report.about);
        case wire::Severity::Warning:
            return log.warning(report.text, report.about);
        case wire::Severity::Error:
            return log.error(report.text, report.about);
    }
}

node::NodeSettings node_settings(const node::NodeOptions& options) {
    node::NodeSettings settings{.name = options.name,
                                .host = options.host,
                                .software = "tessera " + cli::version(),
                                .pid = static_cast<std::uint64_t>(::getpid()),
                                .backend = options.backend,
                                .reproducible = options.isa == "avx2" || options.backend == "null",
                                .workers = options.threads,
                                .store_limit = options.memory_mib << 20,
                                .drain = options.drain};
    if (!options.cache.empty()) settings.cache = options.cache;
    settings.cache_limit = options.cache_mib << 20;
    return settings;
}

int serve(const node::NodeOptions& options) {
    const cli::Log log(options.log);
    const auto blobs = std::make_shared<scene::BlobStore>();
    auto backend = backend::find_backend(options.backend)
                       .make({.threads = options.threads,
                              .isa = options.isa,
                              .device = options.device,
                              .cache_folder = options.cache,
                              .simulated_sample_cost = options.simulated_cost,
                              .blobs = blobs});
    net::ClientSettings client;
    client.endpoint = options.master;
    if (!options.keys.empty()) client.keys = net::KeyDirectory(options.keys).client(options.user);
    const auto context = net::make_zmq_context();
    auto channel = net::make_zmq_client(context, client);
    net::ZmqClient* const sockets = channel.get();  // owned by the node, which calls this on its own thread
    log.info("back-end " + options.backend + " (" + backend->capabilities().kind + ") for " + options.master);

    const SteadyClock clock;
    node::RenderNode node(std::move(channel), std::move(backend), blobs, clock, node_settings(options),
                          {.event = [&log](const node::Report& report) { log_report(log, report); },
                           .reconnect = [sockets] { sockets->reconnect(); }});
    std::stop_source leave, at_once;
    const cli::SignalThread signals({.stop = [&] { leave.request_stop(); },
                                     .stop_at_once = [&] { at_once.request_stop(); },
                                     .reload = {}});
    const node::NodeResult result = node.run(leave.get_token(), at_once.get_token());
    log.info("left after " + std::to_string(result.counters.units_done) + " units");
    return result.failure.empty() ? 0 : cli::ExitRefused;
}

}  // namespace

int main(int argc, char** argv) {
    tessera::disable_malloc_trim();
    cli::block_signals();

    node::NodeOptions options;
    if (const auto exit = node::parse_options(argc, argv, options, std::cout, std::cerr)) return *exit;
    cli::report_crashes(options.log, {});
    try {
        return serve(options);
    } catch (const Error& error) {
        std::cerr << "tessera-node: " << error.what() << "\n";
        return error.code() == ErrorCode::InvalidInput ? 2 : cli::ExitUnavailable;
    } catch (const std::bad_alloc&) {
        std::cerr << "tessera-node: out of memory: give it more, or fewer --threads\n";
        return cli::ExitUnavailable;
    }
}

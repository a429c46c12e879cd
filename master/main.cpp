#include <signal.h>

#include <chrono>
#include <iostream>
#include <thread>

#include "master/config.h"
#include "master/render_master.h"
#include "mediator/base/malloc_trim.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/program/command_line.h"

namespace {

using namespace tessera;

master::EventSink event_log(const cli::Log& log) {
    return [&log](const master::Event& event) {
        switch (event.severity) {
            case wire::Severity::Info:
                return log.info(event.text);
            case wire::Severity::Warning:
                return log.warning(event.text);
            case wire::Severity::Error:
                return log.error(event.text);
        }
    };
}

int serve(const master::MasterOptions& options, const sigset_t& signals) {
    const cli::Log log(options.log);
    const auto context = net::make_zmq_context();
    net::ServerSettings server{.endpoint = options.listen};
    if (!options.keys.empty()) server.keys.emplace(options.keys);
    auto channel = net::make_zmq_server(context, server);

    const SteadyClock clock;
    master::MasterSettings settings{.software = "tessera " + cli::version()};
    settings.liveness.interval =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.heartbeat_seconds));
    settings.session_folder = options.session;
    settings.checkpoint_interval =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.checkpoint_seconds));
    settings.blob_limits.bytes_total = options.blob_quota_mib << 20;
    master::RenderMaster render_master(std::move(channel), std::make_shared<scene::BlobStore>(), clock,
                                       settings, event_log(log));
    log.info("listening on " + options.listen + (options.insecure ? ", not encrypted" : ""));

    std::jthread loop([&](std::stop_token stop) { render_master.run(stop); });
    for (int signal = 0; sigwait(&signals, &signal) == 0 && signal == SIGHUP;) {
        render_master.post([&log](net::Channel& owned) {
            static_cast<net::ZmqServer&>(owned).reload_keys();
            log.info("the allow-list was read again");
        });
    }
    log.info("stopping");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    disable_malloc_trim();
    // Before any thread starts, so that none of them is interrupted: one thread waits for signals.
    sigset_t signals;
    sigemptyset(&signals);
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaddset(&signals, signal);
    pthread_sigmask(SIG_BLOCK, &signals, nullptr);

    master::MasterOptions options;
    if (const auto exit = master::parse_options(argc, argv, options, std::cout, std::cerr)) return *exit;
    try {
        return serve(options, signals);
    } catch (const Error& error) {
        std::cerr << "tessera-master: " << error.what() << "\n";
        return error.code() == ErrorCode::InvalidInput ? 2 : cli::ExitUnavailable;
    }
}

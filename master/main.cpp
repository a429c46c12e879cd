#include <chrono>
#include <iostream>
#include <stop_token>

#include "master/config.h"
#include "master/render_master.h"
#include "mediator/base/malloc_trim.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/program/command_line.h"
#include "mediator/program/crash_report.h"
#include "mediator/program/signals.h"

namespace {

using namespace tessera;

master::EventSink event_log(const cli::Log& log) {
    return [&log](const master::Event& event) {
        if (event.is_detail) return log.debug(event.text, event.about);
        switch (event.severity) {
            case wire::Severity::Info:
                return log.info(event.text, event.about);
            case wire::Severity::Warning:
                return log.warning(event.text, event.about);
            case wire::Severity::Error:
                return log.error(event.text, event.about);
        }
    };
}

int serve(const master::MasterOptions& options) {
    const cli::Log log(options.log);
    const auto context = net::make_zmq_context(static_cast<int>(options.io_threads));
    net::ServerSettings server{.endpoint = options.listen};
    if (!options.keys.empty()) server.keys.emplace(options.keys);
    auto channel = net::make_zmq_server(context, server);
    const net::ZmqServer& counters = *channel;  // the master owns it, and asks it on the same thread

    const SteadyClock clock;
    master::MasterSettings settings{.software = "tessera " + cli::version()};
    settings.liveness.interval =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.heartbeat_seconds));
    settings.refused_traffic = [&counters] {
        const auto dropped = counters.dropped();
        return net::RefusedTraffic{counters.refused_handshakes(), dropped.revoked + dropped.malformed};
    };
    settings.memory_limit = options.memory_mib << 20;
    settings.session_folder = options.session;
    settings.views.orphan_limit =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.orphan_seconds));
    settings.checkpoint_interval =
        std::chrono::duration_cast<Duration>(std::chrono::duration<double>(options.checkpoint_seconds));
    settings.verified_share = options.verify_percent / 100.0;
    settings.views.max_crashes = options.max_crashes;
    settings.blob_limits.bytes_total = options.blob_quota_mib << 20;
    master::RenderMaster render_master(std::move(channel), std::make_shared<scene::BlobStore>(), clock,
                                       settings, event_log(log));
    log.info("listening on " + options.listen + (options.insecure ? ", not encrypted" : ""));

    std::stop_source stop;
    const cli::SignalThread signals({.stop = [&] { stop.request_stop(); },
                                     .stop_at_once = {},
                                     .reload =
                                         [&] {
                                             render_master.post([&log](net::Channel& owned) {
                                                 static_cast<net::ZmqServer&>(owned).reload_keys();
                                                 log.info("the allow-list was read again");
                                             });
                                         }});
    render_master.run(stop.get_token());
    log.info("stopping");
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    disable_malloc_trim();
    cli::block_signals();

    master::MasterOptions options;
    if (const auto exit = master::parse_options(argc, argv, options, std::cout, std::cerr)) return *exit;
    cli::report_crashes(options.log, options.session);
    try {
        return serve(options);
    } catch (const Error& error) {
        std::cerr << "tessera-master: " << error.what() << "\n";
        return error.code() == ErrorCode::InvalidInput ? 2 : cli::ExitUnavailable;
    }
}

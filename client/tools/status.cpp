#include "client/tools/status.h"

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/session.h"
#include "client/tools/chrome_trace.h"
#include "client/tools/cluster_options.h"
#include "client/tools/display_status.h"
#include "mediator/base/old_names.h"
#include "mediator/picture/atomic_file.h"

namespace tessera::tools {

namespace {

using Json = nlohmann::ordered_json;
constexpr const char* StatusName = "status";

struct StatusOptions {
    client::Address address{.endpoint = "tcp://127.0.0.1:7420"};
    bool json = false;
    std::string chrome_trace;
};

Json version_value(const Version& version) {
    return {{"epoch", version.epoch}, {"number", version.number}};
}

Json loop_value(const session::LoopStatus& loop) {
    Json steps = Json::array();
    for (std::size_t i = 0; i < loop.steps.size(); ++i) {
        const bool is_last = i >= session::LoopStatus::Bounds.size();
        steps.push_back(
            {{"seconds", is_last ? Json() : Json(session::LoopStatus::Bounds[i])}, {"count", loop.steps[i]}});
    }
    return {{"steps", steps},
            {"longest_step_seconds", loop.longest_step_seconds},
            {"longest_cpu_seconds", loop.longest_cpu_seconds},
            {"longest_part", loop.longest_part}};
}

Json live_value(const session::SceneStatus& live) {
    if (live.title.empty()) return nullptr;
    Json stages = Json::object();
    for (const session::StageTimes& stage : live.stages) {
        stages[stage.name] = {
            {"count", stage.count}, {"p50_seconds", stage.p50_seconds}, {"p99_seconds", stage.p99_seconds}};
    }
    return {{"title", live.title},
            {"exclusive", live.exclusive},
            {"members", live.members},
            {"views", live.views},
            {"edits", live.edits},
            {"transactions", live.transactions},
            {"edit_bytes", live.edit_bytes},
            {"versions", live.versions},
            {"change_bytes", live.change_bytes},
            {"journal_bytes", live.journal_bytes},
            {"checkpoints", live.checkpoints},
            {"stages", stages}};
}

Json display_value(const session::DisplayStatus& display) {
    if (display.name.empty()) return nullptr;
    Json outputs = Json::array();
    for (const session::OutputStatus& output : display.outputs) {
        outputs.push_back({{"name", output.name},
                           {"host", output.host},
                           {"state", enumerator_name(output.state)},
                           {"frames", output.frames},
                           {"late", output.late},
                           {"samples", output.samples},
                           {"stereo_difference", output.stereo_difference}});
    }
    return {{"name", display.name},
            {"frames", display.frames},
            {"version", {{"epoch", display.version.epoch}, {"number", display.version.number}}},
            {"rate", display.rate},
            {"outputs", outputs}};
}

std::string as_json(const session::ClusterStatus& status) {
    Json nodes = Json::array();
    for (const session::NodeStatus& node : status.nodes) {
        nodes.push_back({{"id", node.summary.id.value},
                         {"name", node.summary.name},
                         {"host", node.summary.host},
                         {"pid", node.summary.pid},
                         {"backend", node.summary.backend},
                         {"kind", node.summary.kind},
                         {"phase", enumerator_name(node.phase)},
                         {"version", version_value(node.version)},
                         {"units_in_flight", node.units_in_flight},
                         {std::string(*old_name("key", "units_in_flight")), node.units_in_flight},
                         {"samples_per_second", node.samples_per_second},
                         {"round_trip_seconds", node.round_trip_seconds},
                         {"stuck", node.stuck},
                         {"quarantine", node.quarantine.empty() ? Json() : Json(node.quarantine)},
                         {"quarantine_seconds", node.quarantine_seconds},
                         {"idle_reason", node.idle_reason.empty() ? Json() : Json(node.idle_reason)},
                         {"film_bytes", node.film_bytes},
                         {"scene_bytes", node.scene_bytes},
                         {"silent_seconds", node.silent_seconds},
                         {"units_waiting", node.units_waiting},
                         {"faults", node.faults},
                         {"last_fault", node.last_fault.empty() ? Json() : Json(node.last_fault)},
                         {"clock_offset_seconds", node.clock_offset_seconds},
                         {"clock_bound_seconds", node.clock_bound_seconds}});
    }
    const session::UnitCounts& units = status.units;
    const Json object{
        {"software", status.software},
        {"version", version_value(status.version)},
        {"uptime_seconds", status.uptime_seconds},
        {"blobs", status.blobs},
        {"blob_bytes", status.blob_bytes},
        {"sessions", status.sessions},
        {"queued", status.queued},
        {"dropped_messages", status.dropped_messages},
        {"refused_film", status.refused_film},
        {"lost_nodes", status.lost_nodes},
        {"lost_sessions", status.lost_sessions},
        {"units",
         {{"issued", units.issued},
          {"reissued", units.reissued},
          {"merged", units.merged},
          {"duplicate", units.duplicate},
          {"cancelled", units.cancelled},
          {"refused", units.refused},
          {"lost", units.lost}}},
        {"wire_bytes",
         {{"control", status.wire_bytes.control},
          {"blobs", status.wire_bytes.blobs},
          {"film", status.wire_bytes.film}}},
        {"resyncs", status.resyncs},
        {"contradictions", status.contradictions},
        {"verified_units", status.verified_units},
        {"caught_exceptions", status.caught_exceptions},
        {"refused_handshakes", status.refused_handshakes},
        {"loop", loop_value(status.loop)},
        {"live", live_value(status.scene)},
        {"display", display_value(status.display)},
        {"nodes", nodes},
    };
    return object.dump(2);
}

// The time within which this fraction of the steps ended: the upper bound of a bucket; 0 = no steps.
double step_seconds(const session::LoopStatus& loop, double fraction) {
    std::uint64_t all = 0, so_far = 0;
    for (const std::uint64_t steps : loop.steps) all += steps;
    for (std::size_t i = 0; i < loop.steps.size() && i < session::LoopStatus::Bounds.size(); ++i) {
        so_far += loop.steps[i];
        if (all > 0 && double(so_far) >= fraction * double(all)) return session::LoopStatus::Bounds[i];
    }
    return all > 0 ? loop.longest_step_seconds : 0.0;
}

// What was refused, sent again or lost since the master has started; nothing if there was none.
void print_troubles(const session::ClusterStatus& status) {
    const std::pair<const char*, std::uint64_t> troubles[] = {
        {"dropped messages (malformed, or not allowed for the role)", status.dropped_messages},
        {"refused films (malformed, or not asked for)", status.refused_film},
        {"refused connections (keys that are not on the allow-list)", status.refused_handshakes},
        {"whole scenes sent again to nodes", status.resyncs},
        {"lost nodes (silent, or the connection broke)", status.lost_nodes},
        {"lost clients (silent, or the connection broke)", status.lost_sessions},
        {"contradictions between nodes of one kind (see the master's log)", status.contradictions},
        {"internal errors (see the master's log)", status.caught_exceptions},
    };
    for (const auto& [what, count] : troubles) {
        if (count > 0) std::printf("%s: %llu\n", what, static_cast<unsigned long long>(count));
    }
}

void print_nodes(const std::vector<session::NodeStatus>& nodes) {
    std::printf("%-16s %-16s %-9s %-10s %8s %6s %14s %9s %9s %6s %9s %21s\n", "node", "host", "back-end",
                "phase", "version", "units", "Msamples/s", "film MiB", "heard s", "faults", "ping ms",
                "clock ms");
    for (const session::NodeStatus& node : nodes) {
        std::printf(
            "%-16.16s %-16.16s %-9.9s %-10s %8llu %6u %14.3f %9.1f %9.1f %6u %9.2f %11.3f +-%7.3f%s\n",
            node.summary.name.c_str(), node.summary.host.c_str(), node.summary.backend.c_str(),
            std::string(enumerator_name(node.phase)).c_str(),
            static_cast<unsigned long long>(node.version.number), node.units_in_flight + node.units_waiting,
            node.samples_per_second * 1e-6, double(node.film_bytes) / 1048576.0, node.silent_seconds,
            node.faults, node.round_trip_seconds * 1e3, node.clock_offset_seconds * 1e3,
            node.clock_bound_seconds * 1e3, node.stuck ? "  stuck" : "");
        if (!node.quarantine.empty()) {
            std::printf("  in quarantine for %.0f s: %s; tessera node release %s ends it\n",
                        node.quarantine_seconds, node.quarantine.c_str(), node.summary.name.c_str());
        } else if (node.faults > 0) {
            std::printf("  latest fault: %s\n", node.last_fault.c_str());
        }
        if (!node.idle_reason.empty()) std::printf("  takes no part: %s\n", node.idle_reason.c_str());
    }
}

void print_table(const session::ClusterStatus& status) {
    std::printf("%s, up %.0f s, scene version %llu, %llu blobs (%.1f MiB)\n", status.software.c_str(),
                status.uptime_seconds, static_cast<unsigned long long>(status.version.number),
                static_cast<unsigned long long>(status.blobs), double(status.blob_bytes) / 1048576.0);
    const session::UnitCounts& units = status.units;
    const auto count = [](std::uint64_t value) { return static_cast<unsigned long long>(value); };
    std::printf(
        "%u sessions, %u waiting; units: %llu issued, %llu reissued; of these %llu merged, %llu duplicate, "
        "%llu cancelled, %llu refused, %llu lost\n",
        status.sessions, status.queued, count(units.issued), count(units.reissued), count(units.merged),
        count(units.duplicate), count(units.cancelled), count(units.refused), count(units.lost));
    print_troubles(status);
    std::printf(
        "event loop: 99.9 %% of its steps within %.1f ms, the longest %.1f ms (%.1f ms of CPU time in %s)\n",
        1e3 * step_seconds(status.loop, 0.999), 1e3 * status.loop.longest_step_seconds,
        1e3 * status.loop.longest_cpu_seconds,
        status.loop.longest_part.empty() ? "none" : status.loop.longest_part.c_str());
    if (status.verified_units > 0)
        std::printf("%llu units verified by a second node\n", count(status.verified_units));
    if (const session::SceneStatus& live = status.scene; !live.title.empty()) {
        std::printf("%s '%s': %u members, %u views, %llu edits, %llu transactions\n",
                    live.exclusive ? "exclusive scene" : "live scene", live.title.c_str(), live.members,
                    live.views, static_cast<unsigned long long>(live.edits),
                    static_cast<unsigned long long>(live.transactions));
        for (const session::StageTimes& stage : live.stages) {
            if (stage.count == 0) continue;
            std::printf("  %-22s %8.1f ms, 99 %% within %8.1f ms\n", stage.name.c_str(),
                        1e3 * stage.p50_seconds, 1e3 * stage.p99_seconds);
        }
    }
    print_display(status.display);
    if (status.nodes.empty()) {
        std::printf("no nodes: start some with tessera-node --master ...\n");
        return;
    }
    print_nodes(status.nodes);
}

int run(const StatusOptions& options) {
    try {
        const SteadyClock clock;
        const auto session = client::connect(options.address, std::make_shared<scene::BlobStore>(), clock,
                                             session_settings("tessera status"));
        if (!options.chrome_trace.empty()) {
            constexpr std::uint32_t Edits = 4096;  // as many as the master keeps and a message holds
            picture::write_atomically(options.chrome_trace, chrome_trace(session->trace(Edits)));
        }
        const session::ClusterStatus status = session->status();
        if (options.json) {
            std::cout << as_json(status) << std::endl;
        } else {
            print_table(status);
        }
        return 0;
    } catch (const Error& error) {
        return report_error(StatusName, exit_code(error.code()), error.what());
    }
}

}  // namespace

Command status_command(cli::CommandLine& program) {
    const auto options = std::make_shared<StatusOptions>();
    cli::CommandLine& command =
        program.command(StatusName, "Show a cluster's nodes, versions, units and rates.");
    add_cluster_options(command, options->address);
    command.flag("--json", "print one JSON object", options->json);
    command.option("--chrome-trace",
                   "write a trace of the latest edits' latencies, for ui.perfetto.dev or chrome://tracing",
                   options->chrome_trace);
    command.examples({"tessera status --master tcp://render-1:7420 --keys ~/.tessera",
                      "tessera status --master tcp://127.0.0.1:7420 --json"});
    return {StatusName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools

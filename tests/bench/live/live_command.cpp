#include "tests/bench/live/live_command.h"

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/tools/interrupts.h"
#include "client/tools/progress_line.h"
#include "client/tools/values.h"
#include "tests/bench/live/live_bench.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* LiveName = "bench live";
constexpr double Mebibyte = 1048576.0;

struct LiveCommandOptions {
    LiveOptions live{.scene = "tests/scenes/studio-1.glb"};
    std::string size = "1280x720";
    bool json = false;
};

double per_second(std::uint64_t count, const LiveResults& results) {
    return results.flood_seconds > 0.0 ? double(count) / results.flood_seconds : 0.0;
}

void print_table(const LiveResults& results) {
    const auto line = [](const char* what, const Times& times) {
        std::printf("  %-34s %8.1f ms %8.1f ms   of %zu\n", what, 1e3 * times.percentile(0.5),
                    1e3 * times.percentile(0.99), times.seconds.size());
    };
    std::printf("sequential edits                          median        p99\n");
    line("edit to its answer", results.edit_to_answer);
    line("edit to the first picture of it", results.edit_to_picture);
    line("camera to the first picture of it", results.camera_to_picture);
    std::printf("  %-34s %8.1f ms %8.1f ms   of %llu\n", "stop of finer passes", 1e3 * results.cancel_p50,
                1e3 * results.cancel_p99, static_cast<unsigned long long>(results.cancellations));
    std::printf("  %-34s %8.0f B to the master, %.0f B a version to the nodes\n", "an edit",
                results.bytes_per_edit, results.bytes_per_version);
    std::printf("concurrent edits of several editors for %.0f s\n", results.flood_seconds);
    std::printf("  %-34s %8.1f /s, %llu sent, %llu accepted\n", "edits",
                per_second(results.flood_edits, results),
                static_cast<unsigned long long>(results.flood_edits),
                static_cast<unsigned long long>(results.flood_accepted));
    std::printf("  %-34s %8.1f /s\n", "pictures", per_second(results.flood_pictures, results));
    line("a newer version was known for", results.picture_age);
    std::printf("  %-34s %8.1f MiB early, %.1f MiB late\n", "memory of the master",
                double(results.memory_early) / Mebibyte, double(results.memory_late) / Mebibyte);
    std::printf("  %-34s %s\n", "all replicas agree", results.replicas_agree ? "yes" : "NO");
}

nlohmann::ordered_json as_json(const LiveResults& results) {
    const auto times = [](const Times& of) {
        return nlohmann::ordered_json{{"count", of.seconds.size()},
                                      {"p50_seconds", of.percentile(0.5)},
                                      {"p99_seconds", of.percentile(0.99)},
                                      {"most_seconds", of.percentile(1.0)}};
    };
    return {{"edit_to_answer", times(results.edit_to_answer)},
            {"edit_to_picture", times(results.edit_to_picture)},
            {"camera_to_picture", times(results.camera_to_picture)},
            {"cancel_to_stopped",
             {{"count", results.cancellations},
              {"p50_seconds", results.cancel_p50},
              {"p99_seconds", results.cancel_p99}}},
            {"bytes_per_edit", results.bytes_per_edit},
            {"bytes_per_version", results.bytes_per_version},
            {"flood",
             {{"seconds", results.flood_seconds},
              {"edits", results.flood_edits},
              {"accepted", results.flood_accepted},
              {"pictures", results.flood_pictures},
              {"picture_age", times(results.picture_age)},
              {"memory_early_bytes", results.memory_early},
              {"memory_late_bytes", results.memory_late},
              {"replicas_agree", results.replicas_agree}}}};
}

int run(LiveCommandOptions options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto size = parse_size(options.size);
    if (!size) return report_error(LiveName, cli::ExitUsage, std::string("--size: ") + size.error().what());
    options.live.width = size->width;
    options.live.height = size->height;
    if (options.live.nodes == 0 || options.live.editors == 0 || options.live.rate == 0)
        return report_error(LiveName, cli::ExitUsage, "--nodes, --editors and --rate must be at least 1");
    LiveResults results;
    {
        ProgressLine line;
        results = run_live(
            options.live, [&](const std::string& text) { line.show(text); }, interrupts.token());
    }
    if (interrupts.token().stop_requested()) return report_error(LiveName, ExitInterrupted, "interrupted");
    if (options.json) {
        std::cout << as_json(results).dump(2) << std::endl;
    } else {
        print_table(results);
    }
    return 0;
}

}  // namespace

Command live_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<LiveCommandOptions>();
    cli::CommandLine& line = bench.command(
        "live",
        "Latency of edits of a live scene, and throughput of many editors. Starts a master and nodes as "
        "separate processes on this machine, with encryption.");
    line.option("--scene", "scene file whose materials are edited", options->live.scene);
    line.option("--backend", "back-end of the nodes", options->live.backend);
    line.option("--nodes", "number of nodes, one thread each", options->live.nodes);
    line.option("--size", "picture size of the view", options->size);
    line.option("--edits", "number of sequential edits and camera moves", options->live.edits);
    line.option("--editors", "clients that edit at the same time", options->live.editors);
    line.option("--rate", "edits per second of all editors together", options->live.rate);
    line.option("--seconds", "duration of the concurrent edits", options->live.flood_seconds);
    line.flag("--json", "print one JSON object instead of the table", options->json);
    line.examples({"tessera bench live",
                   "tessera bench live --nodes 1 --size 640x360 --edits 30 --seconds 10",
                   "tessera bench live --scene room.glb --json > live.json"});
    return {LiveName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

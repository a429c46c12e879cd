#include "tests/bench/live/displays_command.h"

#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/tools/interrupts.h"
#include "client/tools/progress_line.h"
#include "tests/bench/live/displays_bench.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* DisplaysName = "bench displays";
constexpr double MiB = 1048576.0;

struct DisplaysCommandOptions {
    DisplaysOptions displays;
    bool json = false, no_wall = false;
};

void print_table(const DisplaysResults& results) {
    std::printf("%-26s %8s %9s %7s %6s %6s %18s %26s\n", "frame lock", "outputs", "each", "Hz", "mixed",
                "late", "spread p50, p99 ms", "CPU ms a frame: m, n, o");
    for (const LockRun& run : results.locks) {
        const double frames = std::max(1.0, double(run.frames));
        std::printf("%-26s %8u %5ux%-4u %6.1f %6llu %6llu %9.2f %8.2f %10.1f %7.1f %7.1f\n", run.name.c_str(),
                    run.outputs, run.width, run.height, run.rate(),
                    static_cast<unsigned long long>(run.mixed), static_cast<unsigned long long>(run.late),
                    1e3 * run.spread_p50, 1e3 * run.spread_p99, 1e3 * run.master_cpu / frames,
                    1e3 * run.nodes_cpu / frames, 1e3 * run.outputs_cpu / frames);
    }
    if (results.locks.size() >= 2 && results.locks[0].cpu_per_frame() > 0.0) {
        const double fraction = 1.0 - results.locks[1].cpu_per_frame() / results.locks[0].cpu_per_frame();
        std::printf("CURVE's part of the processor time of a frame: %.0f %%\n", 100.0 * fraction);
    }
    if (results.wall.pixels > 0) {
        std::printf("stereo wall of %.1f megapixels: one frame in %.2f s, %.0f MiB at most on the master\n",
                    1e-6 * double(results.wall.pixels), results.wall.seconds,
                    double(results.wall.master_peak_bytes) / MiB);
    }
}

nlohmann::ordered_json as_json(const DisplaysResults& results) {
    nlohmann::ordered_json locks = nlohmann::ordered_json::array();
    for (const LockRun& run : results.locks) {
        locks.push_back({{"name", run.name},
                         {"outputs", run.outputs},
                         {"width", run.width},
                         {"height", run.height},
                         {"encrypted", run.encrypted},
                         {"seconds", run.seconds},
                         {"frames", run.frames},
                         {"rate", run.rate()},
                         {"mixed", run.mixed},
                         {"late", run.late},
                         {"spread_p50_seconds", run.spread_p50},
                         {"spread_p99_seconds", run.spread_p99},
                         {"master_cpu_seconds", run.master_cpu},
                         {"nodes_cpu_seconds", run.nodes_cpu},
                         {"outputs_cpu_seconds", run.outputs_cpu},
                         {"film_bytes", run.film_bytes}});
    }
    return {{"locks", locks},
            {"wall",
             {{"pixels", results.wall.pixels},
              {"seconds", results.wall.seconds},
              {"master_peak_bytes", results.wall.master_peak_bytes}}}};
}

int run(DisplaysCommandOptions options) {
    const Interrupts interrupts;  // before anything that starts threads
    options.displays.wall = !options.no_wall;
    if (options.displays.nodes == 0 || options.displays.columns == 0 || options.displays.rows == 0 ||
        options.displays.columns * options.displays.rows > 64)
        return report_error(DisplaysName, cli::ExitUsage,
                            "--nodes at least 1, --columns x --rows within 1 and 64");
    DisplaysResults results;
    {
        ProgressLine line;
        results = run_displays(
            options.displays, [&](const std::string& text) { line.show(text); }, interrupts.token());
    }
    if (interrupts.token().stop_requested())
        return report_error(DisplaysName, ExitInterrupted, "interrupted");
    if (options.json) {
        std::cout << as_json(results).dump(2) << std::endl;
    } else {
        print_table(results);
    }
    return 0;
}

}  // namespace

Command displays_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<DisplaysCommandOptions>();
    cli::CommandLine& line = bench.command(
        "displays",
        "Rate of new frames on a frame-locked wall of output processes, the cost of the lock and how much "
        "of "
        "it is encryption; and the memory of one frame of a large stereo wall. Starts a master, nodes and "
        "headless tessera-display processes on this machine.");
    line.option("--backend", "back-end of the nodes", options->displays.backend);
    line.option("--nodes", "number of nodes, one thread each", options->displays.nodes);
    line.option("--columns", "outputs side by side", options->displays.columns);
    line.option("--rows", "outputs one above the other", options->displays.rows);
    line.option("--seconds", "duration of each run", options->displays.seconds);
    line.flag("--no-wall", "skip the large stereo wall", options->no_wall);
    line.flag("--json", "print one JSON object instead of the table", options->json);
    line.examples(
        {"tessera bench displays", "tessera bench displays --columns 3 --rows 2 --seconds 5 --no-wall"});
    return {DisplaysName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

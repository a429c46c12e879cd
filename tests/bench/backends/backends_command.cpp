#include "tests/bench/backends/backends_command.h"

#include <iostream>
#include <memory>

#include "client/tools/interrupts.h"
#include "client/tools/progress_line.h"
#include "mediator/picture/atomic_file.h"
#include "tests/bench/backends/backends_bench.h"
#include "tests/bench/backends/backends_report.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* BackendsName = "bench backends";

int run(const BackendsOptions& options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto plan = parse_options(options, tessera::bench::bench_targets());
    if (!plan) return report_error(BackendsName, cli::ExitUsage, plan.error().what());
    std::optional<BackendsResults> results;
    {
        ProgressLine line;
        const BenchProgress progress{
            [&](const std::string& text) { line.show(text); },
            [](const std::string& text) { std::cerr << "tessera bench: " << text << "\n"; }};
        const auto show = [&](const BackendsScene& scene) {
            line.show("");
            if (!options.json) std::cout << as_table(scene) << std::endl;
        };
        results = run_backends(*plan, progress, show, interrupts.token());
    }
    if (!results)
        return report_error(BackendsName, ExitInterrupted,
                            "interrupted before all scenes were measured; no file was written");
    if (!plan->output.empty()) {
        picture::write_atomically(plan->output.string(), plan->output.extension() == ".csv"
                                                             ? as_csv(*results)
                                                             : as_json(*results) + "\n");
    }
    if (options.json) std::cout << as_json(*results) << "\n";
    if (!plan->output.empty() && !options.json) std::cout << "wrote " << plan->output.string() << "\n";
    return 0;
}

}  // namespace

Command backends_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<BackendsOptions>();
    cli::CommandLine& line = bench.command(
        "backends",
        "How fast each back-end is, with the ratio to the first one's in the same run: rays without shading "
        "(camera, shadow and diffuse bounce rays), whole paths, building a scene, refitting its "
        "largest mesh, moving it, the bytes uploaded to the device, and the time until a picture of "
        "one sample per pixel. The back-ends take turns; figures are medians after a warm-up round. "
        "'vulkan-plain' is the Vulkan back-end with a binary BVH, its baseline.");
    line.option("--backends",
                "a,b: back-ends to measure; the others are compared with the first (default: all)",
                options->backends);
    line.option("--device", "Vulkan device: an index or a part of its name; tessera doctor lists them",
                options->device);
    line.option(
        "--scenes",
        "a,b: built-in scenes, scene files, or balls:N for about N triangles (default: all except balls)",
        options->scenes);
    line.option("--size", "picture size", options->size);
    line.option("--spp", "samples per pixel of the path measurement", options->spp);
    line.option("--rays", "number of rays of each kind without shading; use millions for a GPU",
                options->rays);
    line.option("--repeat", "number of measurements; the median is reported", options->repeat);
    line.option("--assets", "folder with the scenes and environments of tests/scenes", options->assets);
    line.option("--jobs", "threads of Embree and of software devices; 0: all cores", options->jobs);
    line.option("-o,--output", "file to write: .json with every measurement, or .csv", options->output);
    line.flag("--json", "print one JSON object instead of the table", options->json);
    line.examples(
        {"tessera bench backends --scenes cornell,balls:1000000",
         "tessera bench backends --scenes room.glb --size 640x360 --repeat 9 -o backends.csv",
         "tessera bench backends --device nvidia --rays 4000000 --size 1280x720 --scenes balls:1000000"});
    return {BackendsName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

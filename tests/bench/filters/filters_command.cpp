#include "tests/bench/filters/filters_command.h"

#include <cstdio>
#include <iostream>
#include <memory>

#include "client/tools/interrupts.h"
#include "client/tools/progress_line.h"
#include "master/filter/catalog.h"
#include "tests/bench/filters/bench_files.h"
#include "tests/bench/filters/json_report.h"
#include "tests/bench/filters/run_bench.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* FiltersName = "bench filters";

int run_filters(const BenchOptions& options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto plan = parse_options(options, filter::catalog());
    if (!plan) return report_error(FiltersName, cli::ExitUsage, plan.error().what());
    for (const std::string& text : plan->left_out) std::cerr << "tessera bench: " << text << "\n";
    BenchFiles files(plan->output);  // reports an unwritable folder before the measurements
    std::optional<BenchResults> results;
    {
        ProgressLine line;
        results = run_bench(
            *plan,
            {.say = [&](const std::string& text) { line.show(text); },
             .warn = [](const std::string& text) { std::cerr << "tessera bench: " << text << "\n"; }},
            interrupts.token());
    }
    if (!results)
        return report_error(FiltersName, ExitInterrupted, "interrupted; finished references are kept");
    const std::vector<std::string> written = files.write(*results);
    if (options.json) {
        std::cout << as_json(*results) << "\n";
        return 0;
    }
    std::printf("%zu scenes, %zu filters in %.0f s on %u threads\n", results->scenes.size(),
                results->filters.size(), results->seconds, results->threads);
    for (const std::string& path : written) std::cout << "wrote " << path << "\n";
    return 0;
}

}  // namespace

Command filters_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<BenchOptions>();
    cli::CommandLine& filters = bench.command("filters",
                                              "Error and time of every denoiser, on the same "
                                              "samples, against two independent references. "
                                              "Writes a self-contained page (filters.html), "
                                              "all numbers (filters.json) and a strip of "
                                              "pictures. References are cached for the next run.");
    filters.option("-o,--output", "folder to write", options->output);
    filters.option("--scenes", "a,b: built-in scenes or scene files (default: all)", options->scenes);
    filters.option("--filters", "a,b:key=value: filters (default: all)", options->filters);
    filters.option("--spp", "samples per pixel to measure at", options->spp);
    filters.option("--size", "picture size at which convergence is measured", options->size);
    filters.option("--large", "picture size of crops and times, up to 16 spp; none: skip", options->large);
    filters.option("--references", "folder of cached references (default: references in the output folder)",
                   options->references);
    filters.option("--reference-spp", "samples per pixel of each of the two references",
                   options->reference_spp);
    filters.option("--assets", "folder with the scenes and environments of tests/scenes", options->assets);
    filters.option("--jobs", "threads for rendering and filtering; 0: all cores", options->jobs);
    filters.flag("--quick", "quick run: up to 64 spp, references of 256 spp, no large size", options->quick);
    filters.flag("--json", "print all numbers as one JSON object", options->json);
    filters.examples(
        {"tessera bench filters --quick", "tessera bench filters -o bench",
         "tessera bench filters --scenes cornell,grids --filters gauss:sigma=1,gauss:sigma=4 --spp 4,16"});
    return {FiltersName, [options](std::string_view) { return run_filters(*options); }};
}

}  // namespace tessera::tools::bench

#include "tests/bench/consistency/consistency_command.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/tools/host_info.h"
#include "client/tools/interrupts.h"
#include "master/filter/catalog.h"
#include "tests/bench/consistency/consistency_bench.h"
#include "tests/bench/filters/plan.h"
#include "tests/bench/scene_loop.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* ConsistencyName = "bench consistency";

struct ConsistencyOptions {
    std::string assets = "tests/scenes", references = "consistency-references", scenes, filters;
    std::string spp = "4,16,64,256,1024,4096", size = "96x54";
    std::uint64_t reference_spp = 8192;
    std::uint32_t seeds = 8, jobs = 0;
    bool json = false, check = false;
};

std::string consistent_filters() {
    std::string names;
    for (const filter::FilterEntry& entry : filter::catalog()) {
        const filter::Description& description = entry.description;
        if (!description.consistent || description.name == "none" || !filter::why_unavailable(entry).empty())
            continue;
        names += (names.empty() ? "" : ",") + std::string(description.name);
    }
    return names;
}

Expected<ConsistencyPlan> parse_options(const ConsistencyOptions& options) {
    // The same lists as of `bench filters`.
    BenchOptions shared;
    shared.assets = options.assets;
    shared.scenes = options.scenes;
    shared.filters = options.filters.empty() ? consistent_filters() : options.filters;
    shared.spp = options.spp;
    shared.size = options.size;
    shared.large = "none";
    shared.reference_spp = options.reference_spp;
    shared.jobs = options.jobs;
    auto plan = parse_options(shared, filter::catalog());
    if (!plan) return tl::unexpected(plan.error());
    if (options.seeds == 0) return failure(ErrorCode::InvalidInput, "--seeds: at least one");
    return ConsistencyPlan{.assets = plan->assets,
                           .references = options.references,
                           .scenes = std::move(plan->scenes),
                           .filters = std::move(plan->filters),
                           .spp = std::move(plan->sizes.front().spp),
                           .reference_spp = options.reference_spp,
                           .size = plan->sizes.front().size,
                           .seeds = options.seeds,
                           .jobs = plan->jobs};
}

void print(const ConsistencyScene& scene) {
    fmt::print("{}\n  {:>5}  {:<24} {:>7} {:>9} {:>8} {:>9}  {:>6} {:>8} {:>6}\n", scene.name, "spp",
               "filter", "relMSE", "<= 1.05 in", "trimmed", "<= 1.05 in", "energy", "specks", "SSIM");
    for (const ConsistencyCell& cell : scene.cells) {
        fmt::print("  {:>5}{} {:<24} {:>7.3f} {:>8.0f} % {:>8.3f} {:>8.0f} %  {:>6.3f} {:>6.2f} % {:>6.3f}\n",
                   cell.spp, cell.has_rare_light() ? '*' : ' ', cell.filter, cell.all.mean,
                   100.0 * cell.all.single, cell.trimmed.mean, 100.0 * cell.trimmed.single, cell.energy,
                   100.0 * cell.specks, cell.ssim);
    }
    for (const auto& [filter, slope] : scene.slopes)
        fmt::print("  {:<10} error falls {:.2f} times as fast as without it\n", filter, slope);
}

nlohmann::ordered_json ratio_json(const ErrorRatio& ratio) {
    return {{"mean", ratio.mean}, {"at_most_1.05", ratio.single}};
}

nlohmann::ordered_json as_json(const ConsistencyScene& scene) {
    nlohmann::ordered_json cells = nlohmann::ordered_json::array(), slopes = nlohmann::ordered_json::object();
    for (const ConsistencyCell& cell : scene.cells) {
        cells.push_back({{"filter", cell.filter},
                         {"spp", cell.spp},
                         {"relmse_over_unfiltered", ratio_json(cell.all)},
                         {"trimmed_relmse_over_unfiltered", ratio_json(cell.trimmed)},
                         {"energy", cell.energy},
                         {"specks", cell.specks},
                         {"ssim", cell.ssim},
                         {"rare_light", cell.rare_light}});
    }
    for (const auto& [filter, slope] : scene.slopes) slopes[filter] = slope;
    return {{"scene", scene.name},
            {"cells", cells},
            {"slope_over_unfiltered", slopes},
            {"broken_promises", broken_promises(scene)}};
}

int run(const ConsistencyOptions& options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto plan = parse_options(options);
    if (!plan) return report_error(ConsistencyName, cli::ExitUsage, plan.error().what());
    tbb::task_arena arena(static_cast<int>(plan->jobs));
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    std::vector<std::string> broken;
    const bool done = measure_each(
        plan->scenes, plan->assets,
        [&](const BenchScene& scene, const BenchProgress& progress) {
            return measure_consistency(scene, *plan, arena, progress, interrupts.token());
        },
        [&](const ConsistencyScene& measured) {
            for (std::string& line : broken_promises(measured)) broken.push_back(std::move(line));
            if (options.json) {
                all.push_back(as_json(measured));
            } else {
                print(measured);
                std::fflush(stdout);
            }
        });
    if (!done)
        return report_error(ConsistencyName, ExitInterrupted,
                            "interrupted before all scenes were measured; finished references are kept");
    if (options.json) std::cout << all.dump(1) << "\n";
    if (!options.json && !broken.empty()) {
        std::cout << "\nNot as promised:\n";
        for (const std::string& line : broken) std::cout << "  " << line << "\n";
    }
    if (options.check && !broken.empty())
        return report_error(ConsistencyName, ExitComparison,
                            std::to_string(broken.size()) + " promises are not kept");
    return 0;
}

}  // namespace

Command consistency_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<ConsistencyOptions>();
    cli::CommandLine& line = bench.command(
        "consistency",
        "Whether denoisers keep their promises: error relative to the unfiltered picture of the same samples "
        "over several seeds, with and without the worst 0.1 % of the pixels, against two references; the "
        "light "
        "that they keep, and specks. A star marks numbers of samples at which more than 1 % of the light is "
        "too rare to be known from accidents. What a consistent denoiser does not keep is listed at the end. "
        "The defaults take about two hours on two cores.");
    line.option("--scenes", "a,b: built-in scenes or scene files (default: all)", options->scenes);
    line.option("--filters", "a,b:key=value: filters (default: all consistent ones)", options->filters);
    line.option("--spp", "samples per pixel to measure at", options->spp);
    line.option("--size", "picture size", options->size);
    line.option("--seeds", "pictures with different seeds", options->seeds);
    line.option("--references", "folder of cached references", options->references);
    line.option("--reference-spp", "samples per pixel of each of the two references", options->reference_spp);
    line.option("--assets", "folder with the scenes and environments of tests/scenes", options->assets);
    line.option("--jobs", "threads; 0: all cores", options->jobs);
    line.flag("--check", "exit with 1 if a promise is not kept", options->check);
    line.flag("--json", "print one JSON array instead of the tables", options->json);
    line.examples(
        {"tessera bench consistency",
         "tessera bench consistency --scenes grids,room-1 --filters fdf,psvgf --spp 4,16,64 --seeds 4"});
    return {ConsistencyName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

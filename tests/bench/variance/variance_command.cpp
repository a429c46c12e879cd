#include "tests/bench/variance/variance_command.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/tools/host_info.h"
#include "client/tools/interrupts.h"
#include "tests/bench/filters/plan.h"
#include "tests/bench/scene_loop.h"
#include "tests/bench/variance/variance_bench.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* VarianceName = "bench variance";

struct VarianceOptions {
    std::string assets = "tests/scenes", scenes, spp = "4,16,64,256", size = "128x64";
    std::uint32_t seeds = 32, jobs = 0;
    bool json = false;
};

Expected<VariancePlan> parse_options(const VarianceOptions& options) {
    VariancePlan plan{.assets = options.assets,
                      .seeds = options.seeds,
                      .jobs = options.jobs != 0 ? options.jobs : core_count()};
    auto scenes = choose_scenes(options.scenes, plan.assets);
    if (!scenes) return failure(ErrorCode::InvalidInput, std::string("--scenes: ") + scenes.error().what());
    plan.scenes = std::move(*scenes);
    auto spp = parse_spp(options.spp);
    if (!spp) return tl::unexpected(spp.error());
    plan.spp = std::move(*spp);
    const auto size = parse_size(options.size);
    if (!size) return failure(ErrorCode::InvalidInput, std::string("--size: ") + size.error().what());
    plan.size = *size;
    if (plan.size.width < 16 || plan.size.height < 16)
        return failure(ErrorCode::InvalidInput,
                       "--size: errors are compared in blocks of 16x16 pixels: at least one");
    if (plan.seeds < 4)
        return failure(ErrorCode::InvalidInput, "--seeds: fewer than 4 say nothing about a variance");
    return plan;
}

void print(const VarianceScene& scene) {
    fmt::print("{}\n  {:>5}  {:>6} {:>9}  {:>6} {:>9} {:>8} {:>6} {:>7}  {:>7} {:>11}\n", scene.name, "spp",
               "blocks", "in 0.7..2", "common", "in 0.7..2", "smallest", "median", "largest", "picture",
               "independent");
    for (const VarianceRow& row : scene.rows) {
        fmt::print(
            "  {:>5}  {:>6} {:>7.1f} %  {:>6} {:>7.1f} % {:>8.2f} {:>6.2f} {:>7.2f}  {:>7.2f} {:>11.2f}\n",
            row.spp, row.blocks + row.rare_blocks, 100.0 * row.within_all, row.blocks, 100.0 * row.within,
            row.smallest, row.median, row.largest, row.whole, row.independent);
    }
}

nlohmann::ordered_json as_json(const VarianceScene& scene) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const VarianceRow& row : scene.rows) {
        rows.push_back({{"spp", row.spp},
                        {"blocks", row.blocks},
                        {"rare_blocks", row.rare_blocks},
                        {"within_all", row.within_all},
                        {"within", row.within},
                        {"smallest", row.smallest},
                        {"median", row.median},
                        {"largest", row.largest},
                        {"picture", row.whole},
                        {"picture_independent", row.independent}});
    }
    return {{"scene", scene.name}, {"rows", rows}};
}

int run(const VarianceOptions& options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto plan = parse_options(options);
    if (!plan) return report_error(VarianceName, cli::ExitUsage, plan.error().what());
    tbb::task_arena arena(static_cast<int>(plan->jobs));
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    const bool done = measure_each(
        plan->scenes, plan->assets,
        [&](const BenchScene& scene, const BenchProgress& progress) {
            return measure_variances(scene, *plan, arena, progress, interrupts.token());
        },
        [&](const VarianceScene& measured) {
            if (options.json) {
                all.push_back(as_json(measured));
            } else {
                print(measured);
                std::fflush(stdout);
            }
        });
    if (!done)
        return report_error(VarianceName, ExitInterrupted, "interrupted before all scenes were measured");
    if (options.json) std::cout << all.dump(1) << "\n";
    return 0;
}

}  // namespace

Command variance_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<VarianceOptions>();
    cli::CommandLine& line = bench.command(
        "variance",
        "Accuracy of the film's variances: the estimates of single films, divided by the true variance of "
        "the "
        "mean, which films with different seeds give. In blocks of 16x16 pixels and for the whole picture; 1 "
        "is "
        "exact. Blocks with a relative error below 0.3 % do not count. 'common' are blocks where 5x5 pixels "
        "expect at least three of the samples that cause the variance. 'independent' is the whole picture's "
        "as "
        "if samples were not stratified.");
    line.option("--scenes", "a,b: built-in scenes or scene files (default: all)", options->scenes);
    line.option("--spp", "samples per pixel to measure at", options->spp);
    line.option("--size", "picture size", options->size);
    line.option("--seeds", "number of films to compare", options->seeds);
    line.option("--assets", "folder with the scenes and environments of tests/scenes", options->assets);
    line.option("--jobs", "threads; 0: all cores", options->jobs);
    line.flag("--json", "print one JSON array instead of the tables", options->json);
    line.examples({"tessera bench variance --scenes grids,room-1",
                   "tessera bench variance --scenes product.glb --spp 16,1024 --seeds 12 --json"});
    return {VarianceName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

#include "tests/bench/adaptive/adaptive_command.h"

#include <fmt/format.h>

#include <charconv>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "client/tools/host_info.h"
#include "client/tools/interrupts.h"
#include "master/filter/catalog.h"
#include "tests/bench/adaptive/adaptive_bench.h"
#include "tests/bench/filters/plan.h"
#include "tests/bench/scene_loop.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* AdaptiveName = "bench adaptive";

struct AdaptiveOptions {
    std::string assets = "tests/scenes", references = "adaptive-references", scenes, filter, spp = "32",
                noise = "0.2,0.1", errors, size = "96x54";
    std::uint64_t reference_spp = 8192;
    std::uint32_t seeds = 4, jobs = 0;
    bool json = false;
};

Expected<std::vector<double>> parse_goals(const std::string& option, const std::string& text) {
    std::vector<double> goals;
    for (const std::string& item : split_list(text)) {
        double value = 0.0;
        const auto result = std::from_chars(item.data(), item.data() + item.size(), value);
        if (result.ec != std::errc() || result.ptr != item.data() + item.size() || !(value > 0.0) ||
            value > 1.0)
            return failure(ErrorCode::InvalidInput,
                           option + ": '" + item + "' is not above 0 and up to 1: write 0.2,0.1");
        goals.push_back(value);
    }
    return goals;
}

Expected<AdaptivePlan> parse_options(const AdaptiveOptions& options) {
    AdaptivePlan plan{.assets = options.assets,
                      .references = options.references,
                      .seeds = options.seeds,
                      .jobs = options.jobs != 0 ? options.jobs : core_count(),
                      .reference_spp = options.reference_spp};
    auto scenes = choose_scenes(options.scenes, plan.assets);
    if (!scenes) return failure(ErrorCode::InvalidInput, std::string("--scenes: ") + scenes.error().what());
    plan.scenes = std::move(*scenes);
    if (!options.spp.empty()) {  // else only goals are compared
        auto spp = parse_spp(options.spp);
        if (!spp) return tl::unexpected(spp.error());
        plan.spp = std::move(*spp);
    }
    auto noise = parse_goals("--noise", options.noise);
    if (!noise) return tl::unexpected(noise.error());
    plan.noise = std::move(*noise);
    auto errors = parse_goals("--error", options.errors);
    if (!errors) return tl::unexpected(errors.error());
    plan.errors = std::move(*errors);
    if (!options.filter.empty()) {
        auto choice = filter::parse_choice(options.filter, filter::catalog());
        if (!choice)
            return failure(ErrorCode::InvalidInput, std::string("--filter: ") + choice.error().what());
        plan.filter = std::move(*choice);
    }
    if (!plan.errors.empty()) {
        if (!plan.filter) return failure(ErrorCode::InvalidInput, "--error: of which filter? Add --filter");
        if (const std::string why = filter::why_no_error_estimate(*plan.filter); !why.empty())
            return failure(ErrorCode::InvalidInput, "--error: " + why);
    }
    const auto size = parse_size(options.size);
    if (!size) return failure(ErrorCode::InvalidInput, std::string("--size: ") + size.error().what());
    plan.size = *size;
    if (plan.seeds == 0) return failure(ErrorCode::InvalidInput, "--seeds: at least 1");
    if (plan.reference_spp == 0) return failure(ErrorCode::InvalidInput, "--reference-spp: at least 1");
    return plan;
}

double median(const std::vector<double>& sorted) {
    return sorted.empty() ? 0.0 : sorted[sorted.size() / 2];
}

std::string range_of(const std::vector<double>& sorted) {
    return sorted.empty()
               ? ""
               : fmt::format("{:5.2f} {:5.2f} {:5.2f}", sorted.front(), median(sorted), sorted.back());
}

void print(const AdaptiveScene& scene) {
    fmt::print(
        "{}: units with a quarter of the pixels have {:.2f} times the samples per second\n"
        "  {:>7}  {:>7} {:>5}  {:>6} {:>7} {:>7}  {:>17}  {:>8}  {:>17}  {:>17}\n",
        scene.name, scene.masked_rate, "goal", "spp", "steps", "gain", "trimmed", "light", "true noise",
        "deciding", "true error", "over estimate");
    for (const AdaptiveRow& row : scene.rows) {
        const double goal = row.error > 0.0 ? row.error : row.noise;
        fmt::print(
            "  {:>7}  {:>7.1f} {:>5.1f}  {:>6.2f} {:>7.2f} {:>7.4f}  {:>17}  {:>6.2f} %  {:>17}  {:>17}\n",
            goal > 0.0 ? fmt::format("{:g}", goal) : "", row.spp, row.steps, row.gain, row.trimmed_gain,
            row.light, range_of(row.true_noise), 100.0 * row.deciding, range_of(row.true_error),
            range_of(row.estimated_error));
    }
}

nlohmann::ordered_json as_json(const AdaptiveScene& scene) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const AdaptiveRow& row : scene.rows) {
        rows.push_back(
            {{"noise", row.noise > 0.0 ? nlohmann::ordered_json(row.noise) : nlohmann::ordered_json()},
             {"error", row.error > 0.0 ? nlohmann::ordered_json(row.error) : nlohmann::ordered_json()},
             {"spp", row.spp},
             {"steps", row.steps},
             {"gain", row.gain},
             {"trimmed_gain", row.trimmed_gain},
             {"light", row.light},
             {"true_noise", row.true_noise},
             {"true_error", row.true_error},
             {"true_over_estimated_error", row.estimated_error},
             {"deciding", row.deciding}});
    }
    return {{"scene", scene.name}, {"masked_rate", scene.masked_rate}, {"rows", rows}};
}

int run(const AdaptiveOptions& options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto plan = parse_options(options);
    if (!plan) return report_error(AdaptiveName, cli::ExitUsage, plan.error().what());
    tbb::task_arena arena(static_cast<int>(plan->jobs));
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    const bool done = measure_each(
        plan->scenes, plan->assets,
        [&](const BenchScene& scene, const BenchProgress& progress) {
            return measure_adaptive(scene, *plan, arena, progress, interrupts.token());
        },
        [&](const AdaptiveScene& measured) {
            if (options.json) {
                all.push_back(as_json(measured));
            } else {
                print(measured);
                std::fflush(stdout);
            }
        });
    if (!done)
        return report_error(AdaptiveName, ExitInterrupted, "interrupted before all scenes were measured");
    if (options.json) std::cout << all.dump(1) << "\n";
    return 0;
}

}  // namespace

Command adaptive_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<AdaptiveOptions>();
    cli::CommandLine& line =
        bench.command("adaptive",
                      "Samples where they are needed, compared with as many uniform "
                      "ones: 'gain' is the relMSE of uniform over that of "
                      "adaptive samples, 'trimmed' the same without one pixel in a "
                      "thousand, 'light' the mean luminance over that of "
                      "uniform samples. 'true noise' is the root of the true relMSE of "
                      "the unfiltered picture over the noise that was asked for, or over its "
                      "estimate where a number of samples was: smallest, median and "
                      "largest of the seeds; 'true error' is the relMSE of the filtered picture over "
                      "the error that was asked for, then over its estimate. 'deciding' is the part of the "
                      "time that the choice of pixels takes.");
    line.option("--scenes", "a,b: built-in scenes or scene files (default: all)", options->scenes);
    line.option("--spp", "mean samples per pixel to compare at, 16 or more; '': none", options->spp);
    line.option("--noise", "noise to stop at; '': none", options->noise);
    line.option("--error", "relMSE of the filtered picture to stop at", options->errors);
    line.option("--filter", "compare the pictures of this filter (default: unfiltered ones)",
                options->filter);
    line.option("--size", "picture size", options->size);
    line.option("--seeds", "number of films", options->seeds);
    line.option("--reference-spp", "samples per pixel of each of two references", options->reference_spp);
    line.option("--references", "folder of the references; they are reused", options->references);
    line.option("--assets", "folder with the scenes and environments of tests/scenes", options->assets);
    line.option("--jobs", "threads; 0: all cores", options->jobs);
    line.flag("--json", "print one JSON array instead of the tables", options->json);
    line.examples({"tessera bench adaptive --scenes grids,room-1",
                   "tessera bench adaptive --scenes product.glb --spp 64 --noise 0.05 --seeds 20 --json"});
    return {AdaptiveName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

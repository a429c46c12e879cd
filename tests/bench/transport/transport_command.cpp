#include "tests/bench/transport/transport_command.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "client/tools/host_info.h"
#include "client/tools/interrupts.h"
#include "mediator/backend/catalog.h"
#include "mediator/picture/atomic_file.h"
#include "tests/bench/filters/plan.h"
#include "tests/bench/scene_loop.h"
#include "tests/bench/scenes/built_in_scenes.h"
#include "tests/bench/transport/cycles.h"
#include "tests/bench/transport/transport_report.h"

namespace tessera::tools::bench {

namespace {

constexpr const char* TransportName = "bench transport";

struct TransportOptions {
    std::string output = "bench-transport", references, assets = "tests/scenes", scenes, backends,
                spp = "1,2,4,8,16,32,64,128,256", size = "128x72", cycles = "auto";
    std::uint64_t reference_spp = 1024;
    std::uint32_t seeds = 2, jobs = 0;
    bool quick = false, json = false;
};

// All of this build but the one that renders nothing.
Expected<std::vector<std::string>> choose_backends(const std::string& list) {
    std::vector<std::string> names = split_list(list);
    if (names.empty()) {
        for (const backend::BackendEntry& entry : backend::catalog()) {
            if (entry.name != "null") names.push_back(entry.name);
        }
    }
    for (const std::string& name : names) {
        try {
            (void)backend::find_backend(name);
        } catch (const Error& error) {
            return failure(ErrorCode::InvalidInput, std::string("--backends: ") + error.what());
        }
    }
    return names;
}

Expected<bool> choose_cycles(const std::string& text) {
    if (text == "off") return false;
    if (text == "auto") return has_cycles();
    if (text != "on")
        return failure(ErrorCode::InvalidInput, "--cycles: '" + text + "': write on, off or auto");
    if (has_cycles()) return true;
    return failure(ErrorCode::InvalidInput,
                   "--cycles: there is no program `blender`: install Debian's package blender");
}

Expected<TransportPlan> parse_options(const TransportOptions& options) {
    TransportPlan plan{.output = options.output,
                       .references = options.references.empty()
                                         ? std::filesystem::path(options.output) / "references"
                                         : std::filesystem::path(options.references),
                       .assets = options.assets,
                       .reference_spp = options.quick ? std::min<std::uint64_t>(options.reference_spp, 512)
                                                      : options.reference_spp,
                       .seeds = options.seeds,
                       .jobs = options.jobs != 0 ? options.jobs : core_count()};
    auto scenes = choose_scenes(options.scenes, plan.assets);
    if (!scenes) return failure(ErrorCode::InvalidInput, std::string("--scenes: ") + scenes.error().what());
    plan.scenes = std::move(*scenes);
    if (options.scenes.empty()) {
        for (const BuiltIn& scene : built_in_scenes()) {
            if (!scene.is_default) plan.scenes.emplace_back(scene.name);
        }
    }
    auto backends = choose_backends(options.backends);
    if (!backends) return tl::unexpected(backends.error());
    plan.backends = std::move(*backends);
    auto spp = parse_spp(options.spp);
    if (!spp) return tl::unexpected(spp.error());
    plan.spp = std::move(*spp);
    if (options.quick) std::erase_if(plan.spp, [](std::uint64_t n) { return n > 32; });
    if (plan.spp.empty()) return failure(ErrorCode::InvalidInput, "--spp: a quick run has at most 32");
    const auto size = parse_size(options.size);
    if (!size) return failure(ErrorCode::InvalidInput, std::string("--size: ") + size.error().what());
    plan.size = *size;
    const auto cycles = choose_cycles(options.cycles);
    if (!cycles) return tl::unexpected(cycles.error());
    plan.cycles = *cycles;
    if (plan.seeds == 0) return failure(ErrorCode::InvalidInput, "--seeds: at least 1");
    if (plan.reference_spp == 0) return failure(ErrorCode::InvalidInput, "--reference-spp: at least 1");
    return plan;
}

int run(const TransportOptions& options) {
    const Interrupts interrupts;  // before anything that starts threads
    const auto plan = parse_options(options);
    if (!plan) return report_error(TransportName, cli::ExitUsage, plan.error().what());
    std::error_code error;  // an unwritable folder is reported before the measurements
    std::filesystem::create_directories(plan->output, error);
    if (error)
        return report_error(TransportName, exit_code(ErrorCode::Io),
                            "cannot create the folder '" + plan->output.string() + "': " + error.message());
    tbb::task_arena arena(static_cast<int>(plan->jobs));
    std::vector<TransportScene> all;
    const bool done = measure_each(
        plan->scenes, plan->assets,
        [&](const BenchScene& scene, const BenchProgress& progress) {
            return measure_transport(scene, *plan, arena, progress, interrupts.token());
        },
        [&](const TransportScene& measured) {
            all.push_back(measured);
            if (options.json) return;
            std::cout << transport_text(measured, *plan) << std::flush;
        });
    if (!done)
        return report_error(TransportName, ExitInterrupted, "interrupted; finished references are kept");
    const std::string json = transport_json(all, *plan) + "\n";
    const std::string json_file = (plan->output / "transport.json").string(),
                      page = (plan->output / "transport.html").string();
    picture::write_atomically(json_file, json);
    picture::write_atomically(page, transport_html(all, *plan));
    picture::write_atomically((plan->output / "transport.svg").string(), transport_svg(all));
    if (options.json) {
        std::cout << json;
        return 0;
    }
    for (const std::string& backend : plan->backends) {
        if (const double mean = mean_time_to_equal_error(all, backend); mean > 0.0)
            fmt::print("{}: time to equal error over Cycles {:.2f} (geometric mean)\n", backend, mean);
    }
    fmt::print("wrote {}\nwrote {}\n", json_file, page);
    return 0;
}

}  // namespace

Command transport_command(cli::CommandLine& bench) {
    const auto options = std::make_shared<TransportOptions>();
    cli::CommandLine& line = bench.command(
        "transport",
        "Error of unfiltered pictures over samples and time, of each "
        "back-end and, where Debian's blender is installed, of "
        "Cycles: relMSE against two independent references, HDR-FLIP, the "
        "light that is kept, the share of it in the brightest samples, rays per sample, time of the "
        "first picture, memory, and noise and time by the lengths of paths. Writes one page with curves "
        "(transport.html), the curves alone "
        "(transport.svg) and all numbers (transport.json).");
    line.option("-o,--output", "folder to write", options->output);
    line.option("--scenes", "a,b: built-in scenes or scene files (default: all)", options->scenes);
    line.option("--backends", "a,b: back-ends (default: all)", options->backends);
    line.option("--cycles", "on, off or auto: whether Cycles renders as well", options->cycles);
    line.option("--spp", "samples per pixel to measure at", options->spp);
    line.option("--size", "picture size", options->size);
    line.option("--seeds", "number of films", options->seeds);
    line.option("--reference-spp", "samples per pixel of each of two references", options->reference_spp);
    line.option("--references", "folder of cached references (default: references in the output folder)",
                options->references);
    line.option("--assets", "folder with the scenes and environments of tests/scenes", options->assets);
    line.option("--jobs", "threads; 0: all cores", options->jobs);
    line.flag("--quick", "quick run: up to 32 spp, references of 512 spp", options->quick);
    line.flag("--json", "print all numbers as one JSON object", options->json);
    line.examples({"tessera bench transport --quick", "tessera bench transport -o bench --cycles off",
                   "tessera bench transport --scenes kitchen.glb --backends embree --seeds 8"});
    return {TransportName, [options](std::string_view) { return run(*options); }};
}

}  // namespace tessera::tools::bench

#include "tests/bench/backends/backends_plan.h"

#include <algorithm>

#include "client/tools/host_info.h"
#include "tests/bench/scenes/scenes.h"

namespace tessera::tools::bench {

namespace {

// Limit of one dispatch of 65,535 workgroups.
constexpr std::uint32_t MostRays = 4'000'000;
constexpr std::uint64_t MostSamples = 1u << 16;

tl::unexpected<Error> wrong_option(const std::string& option, const std::string& text) {
    return failure(ErrorCode::InvalidInput, option + ": " + text);
}

}  // namespace

Expected<BackendsPlan> parse_options(const BackendsOptions& options,
                                     const std::vector<tessera::bench::BenchTarget>& targets) {
    BackendsPlan plan{.output = options.output,
                      .assets = options.assets,
                      .spp = options.spp,
                      .rays = options.rays,
                      .repeat = options.repeat,
                      .jobs = options.jobs != 0 ? options.jobs : core_count()};
    auto scenes = choose_scenes(options.scenes, plan.assets);
    if (!scenes) return wrong_option("--scenes", scenes.error().what());
    plan.scenes = std::move(*scenes);

    std::vector<std::string> names = split_list(options.backends);
    std::string known;
    for (const auto& target : targets) {
        known += (known.empty() ? "" : ", ") + target.name;
        if (options.backends.empty()) names.push_back(target.name);
    }
    for (const std::string& name : names) {
        const auto found = std::ranges::find(targets, name, &tessera::bench::BenchTarget::name);
        if (found == targets.end()) {
            return wrong_option("--backends", "unknown back-end '" + name + "': choose from " + known);
        }
        plan.targets.push_back({*found, found->chooses_device ? options.device : ""});
    }
    if (plan.targets.empty()) return wrong_option("--backends", "the list is empty: choose from " + known);
    const auto size = parse_size(options.size);
    if (!size) return wrong_option("--size", size.error().what());
    plan.size = *size;
    if (plan.spp == 0 || plan.spp > MostSamples) {
        return wrong_option("--spp", "give a number from 1 to " + std::to_string(MostSamples));
    }
    if (plan.rays < 1024 || plan.rays > MostRays) {
        return wrong_option("--rays", "give a number from 1024 to " + std::to_string(MostRays));
    }
    if (plan.repeat == 0) return wrong_option("--repeat", "at least 1");
    const std::string extension = plan.output.extension().string();
    if (!plan.output.empty() && extension != ".json" && extension != ".csv") {
        return wrong_option("--output",
                            "'" + options.output + "' has no known format: use the extension .json or .csv");
    }
    return plan;
}

}  // namespace tessera::tools::bench

#include "tests/bench/filters/run_bench.h"

#include "client/tools/view_attributes.h"
#include "mediator/base/clock.h"
#include "mediator/program/command_line.h"
#include "tests/bench/filters/speed.h"

namespace tessera::tools::bench {

namespace {

FilterInfo describe(const filter::Choice& choice) {
    const filter::Description& filter = choice.entry->description;
    FilterInfo info{.text = to_text(choice),
                    .name = std::string(filter.name),
                    .summary = std::string(filter.summary),
                    .source = std::string(filter.source),
                    .path_class = name(filter.path_class),
                    .is_consistent = filter.consistent,
                    .is_temporal = filter.temporal};
    for (const frame::ChannelInfo& entry : frame::channel_table()) {
        if (!choice.channels().contains(entry.channel)) continue;
        info.channels += (info.channels.empty() ? "" : ", ") + std::string(entry.name);
    }
    return info;
}

}  // namespace

std::optional<BenchResults> run_bench(const BenchPlan& plan, const BenchProgress& progress,
                                      const std::stop_token& stop) {
    const SteadyClock clock;
    const TimePoint started = clock.now();
    tbb::task_arena arena(static_cast<int>(plan.jobs));
    const backend::Capabilities renderer = bench::renderer();
    BenchResults results{
        .software = "tessera " + cli::version(), .backend = renderer.kind, .threads = plan.jobs};
    BenchPlan possible = plan;
    std::erase_if(possible.filters, [&](const filter::Choice& choice) {
        if (renderer.channels.contains(choice.channels())) return false;
        results.notes.push_back("filter '" + to_text(choice) +
                                "' is left out: the renderer lacks a channel that it reads");
        return true;
    });
    for (const std::string& note : results.notes) progress.warn(note);
    for (const filter::Choice& choice : possible.filters) results.filters.push_back(describe(choice));
    for (const std::string& name : possible.scenes) {
        progress.say(name + ": loading");
        const auto scene = load_scene(name, possible.assets);
        if (!scene) throw scene.error();
        auto measured = measure_scene(*scene, possible, arena, progress, stop);
        if (!measured) return std::nullopt;
        results.scenes.push_back(std::move(*measured));
        if (!possible.measures_speed || results.scenes.size() > 1) continue;
        auto speed = measure_speed(*scene, possible, arena, progress, stop);
        if (!speed) return std::nullopt;
        results.speed = std::move(*speed);
    }
    results.seconds = seconds(clock.now() - started);
    return results;
}

}  // namespace tessera::tools::bench

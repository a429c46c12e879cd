// Time of every filter at 1280x720 and 4 samples, compared with a plain copy of the picture. Arguments that
// are not flags replace the catalog: `tessera_filter_bench pixel:method=brute nlm`.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "tests/filter/synthetic.h"

namespace {

using namespace tessera;
using namespace tessera::filter;

constexpr std::uint32_t Width = 1280, Height = 720;
constexpr double Megapixels = Width * Height * 1e-6;

const Inputs& inputs() {
    static const Inputs Sample =
        synthetic_inputs(Width, Height, 4, [](std::uint32_t x, std::uint32_t y, std::uint64_t sample) {
            return shadowed_texture(Width, Height, x, y, sample);
        });
    return Sample;
}

// The upper bound of all of the following: each byte of the picture read once and written once.
void plain_copy(benchmark::State& state) {
    const Planes& from = inputs().mean(frame::Channel::Radiance);
    Planes to = from;
    for (auto _ : state) {
        std::ranges::copy(from.values(), to.values().begin());
        benchmark::DoNotOptimize(to.values().data());
        benchmark::ClobberMemory();
    }
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * 2 * from.byte_size()));
}

// All cores, warm memory; the column CPU is the total of all threads. `bytes/px` is the traffic reported by
// the filter; `GB/s` follows from it.
void run(benchmark::State& state, const std::string& text) {
    const auto choice = parse_choice(text, catalog());
    if (!choice) {
        state.SkipWithError(choice.error().what());
        return;
    }
    if (const std::string why = why_unavailable(*choice->entry); !why.empty()) {
        state.SkipWithError(why.c_str());
        return;
    }
    const auto filter = choice->entry->make(Width, Height);
    tbb::task_arena arena;
    Output out;
    filter->run(inputs(), choice->values, out, {arena, {}});
    Report report;
    const auto started = std::chrono::steady_clock::now();
    for (auto _ : state) {
        filter->reset();
        report = filter->run(inputs(), choice->values, out, {arena, {}});
    }
    const double ms = 1e3 * seconds(std::chrono::steady_clock::now() - started) /
                      static_cast<double>(std::max<benchmark::IterationCount>(1, state.iterations()));
    double bytes = 0.0;
    for (const Pass& pass : report.passes) {
        bytes += pass.bytes_per_pixel;
        state.counters["ms " + std::string(pass.name)] += 1e3 * seconds(pass.time);
    }
    state.counters["ms/Mpx"] = ms / Megapixels;
    state.counters["bytes/px"] = bytes;
    state.counters["GB/s"] = bytes * Megapixels * 1e-3 / (ms * 1e-3);
}

}  // namespace

int main(int count, char** arguments) {
    benchmark::Initialize(&count, arguments);
    std::vector<std::string> choices(arguments + 1, arguments + count);
    if (choices.empty()) {
        for (const FilterEntry& entry : catalog()) {
            const std::string why = why_unavailable(entry);
            if (why.empty()) {
                choices.emplace_back(entry.description.name);
            } else {
                std::fprintf(stderr, "%s is left out: %s\n", std::string(entry.description.name).c_str(),
                             why.c_str());
            }
        }
    }
    benchmark::RegisterBenchmark("plain_copy", plain_copy)->Unit(benchmark::kMillisecond)->UseRealTime();
    for (const std::string& choice : choices) {
        benchmark::RegisterBenchmark(choice.c_str(), run, choice)
            ->Unit(benchmark::kMillisecond)
            ->MeasureProcessCPUTime()
            ->UseRealTime();
    }
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}

// Compositing of layers by depth and alpha at 1920x1080, compared with a plain copy of the same bytes on as
// many threads; the column CPU is the total of all threads.
#include <benchmark/benchmark.h>

#include <algorithm>

#include "master/render/compose/layers.h"
#include "mediator/base/parallel.h"
#include "mediator/base/random.h"

namespace {

using namespace tessera;

constexpr std::uint32_t Width = 1920, Height = 1080;
constexpr std::uint32_t Read = 5, Written = 4;  // planes: of each layer; of the picture

// Layers whose order changes from pixel to pixel.
std::vector<filter::Planes> make_pictures(std::size_t count) {
    std::vector<filter::Planes> pictures;
    CounterRandom random(3);
    for (std::size_t i = 0; i < count; ++i) {
        pictures.emplace_back(Width, Height, Read);
        for (float& value : pictures.back().values()) value = static_cast<float>(random.uniform());
    }
    return pictures;
}

void set_bytes(benchmark::State& state, std::size_t layers) {
    const std::size_t bytes = (layers * Read + Written) * Width * Height * sizeof(float);
    state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

void compose_layers(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::vector<filter::Planes> pictures = make_pictures(count);
    std::vector<master::Layer> layers;
    for (const filter::Planes& p : pictures) {
        layers.push_back({{p.plane(0), p.plane(1), p.plane(2)}, p.plane(3), p.plane(4)});
    }
    tbb::task_arena arena;
    filter::Planes out;
    for (auto _ : state) {
        master::compose(layers, Width, Height, out, arena);
        benchmark::DoNotOptimize(out.values().data());
        benchmark::ClobberMemory();
    }
    set_bytes(state, count);
}
BENCHMARK(compose_layers)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

// Copies as many bytes: half of them read, half written.
void plain_copy(benchmark::State& state) {
    const auto count = static_cast<std::size_t>(state.range(0));
    const std::size_t values = (count * Read + Written) * Width * Height / 2;
    const std::vector<float> from(values, 1.0f);
    std::vector<float> to(values);
    tbb::task_arena arena;
    constexpr std::size_t Piece = 1 << 16;
    for (auto _ : state) {
        parallel_for(arena, (values + Piece - 1) / Piece, [&](std::size_t i) {
            const std::size_t first = i * Piece, size = std::min(Piece, values - first);
            std::copy_n(from.data() + first, size, to.data() + first);
        });
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    set_bytes(state, count);
}
BENCHMARK(plain_copy)
    ->Arg(1)
    ->Arg(2)
    ->Arg(4)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();

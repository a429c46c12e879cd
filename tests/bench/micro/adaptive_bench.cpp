// Decisions about the next samples of a 1280x720 picture, compared with a copy of its film. The nodes wait meanwhile: docs/benchmarks.md
// has the time that their samples take.
#include <benchmark/benchmark.h>

#include "tests/master/adaptive/simulated_picture.h"

namespace {

using namespace tessera;
using namespace tessera::master;

// A quarter of the picture is noisy; one sample in a thousand is bright.
float sample(std::int32_t x, std::int32_t y, CounterRandom& random) {
    const float noise = x < 640 && y < 360 ? 1.0f : 0.1f;
    const auto value = 1.0f + noise * (static_cast<float>(random.uniform()) - 0.5f);
    return random.uniform() < 1e-3 ? 10.0f * value : value;
}

const SimulatedPicture& picture() {
    static const SimulatedPicture Picture(1280, 720, 32, sample);
    return Picture;
}

void copy_of_the_film(benchmark::State& state) {
    const SimulatedPicture& rendered = picture();
    for (auto _ : state) benchmark::DoNotOptimize(rendered.film());
}
BENCHMARK(copy_of_the_film)->Unit(benchmark::kMillisecond);

// range: a thousandth of the noise that is wanted, then threads. Most pixels are doubled to reach 0.01, few to reach 0.1.
void decision(benchmark::State& state) {
    const AdaptiveSettings settings{.noise = 1e-3 * double(state.range(0)), .max_samples = 4096};
    const SimulatedPicture& rendered = picture();
    tbb::task_arena arena(static_cast<int>(state.range(1)));
    std::uint64_t pixels = 0;
    for (auto _ : state) {
        const Step step = rendered.next(settings, &arena);
        pixels = 0;
        for (const Round& round : step.rounds) {
            for (const RoundMask& mask : *round.masks) pixels += mask.pixels;
        }
    }
    state.counters["pixels"] = double(pixels);
}
BENCHMARK(decision)->Args({10, 1})->Args({10, 2})->Args({100, 1})->Args({100, 2})->UseRealTime()->Unit(
    benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();

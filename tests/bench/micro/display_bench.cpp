// Warping the pictures of the eyes to an output's device, compared with a plain copy of the same bytes.
#include <benchmark/benchmark.h>
#include <immintrin.h>

#include <cmath>
#include <cstring>

#include "mediator/base/random.h"
#include "mediator/display/frustum.h"
#include "mediator/display/output_pipeline.h"

namespace {

using namespace tessera;
using namespace tessera::display;

constexpr std::uint32_t Width = 1440, Height = 1050;
constexpr std::size_t Values = std::size_t{3} * Width * Height;

std::vector<std::uint16_t> picture() {
    CounterRandom random(1);
    std::vector<std::uint16_t> halves(Values);
    for (std::uint16_t& half : halves) half = _cvtss_sh(static_cast<float>(random.uniform()), 0);
    return halves;
}

EyePicture eye_picture(const std::vector<std::uint16_t>& halves) {
    return {EyePicture::Encoding::LinearHalf, Width, Height, std::as_bytes(std::span(halves))};
}

// A wall two metres away and a tilted projector, with a warp map node per pixel.
Output projector(scene::BlobStore& arrays) {
    Output output{.name = "projector", .width = Width, .height = Height};
    output.plane.origin = {0, 0, -2};
    output.plane.hull = {{-1, -0.8, -2}, {1, -0.8, -2}, {1, 0.8, -2}, {-1, 0.8, -2}};
    output.view_width = Width;
    output.view_height = Height;
    std::vector<float> points;
    for (std::uint32_t y = 0; y < Height; ++y)
        for (std::uint32_t x = 0; x < Width; ++x) {
            const float s = 2.0f * (static_cast<float>(x) + 0.5f) / Width - 1.0f;
            const float t = 1.0f - 2.0f * (static_cast<float>(y) + 0.5f) / Height;
            points.insert(points.end(), {0.9f * s / (1.0f + 0.1f * t), 0.7f * t + 0.02f * s, -2.0f});
        }
    output.points = {.columns = Width,
                     .rows = Height,
                     .components = 3,
                     .nodes = Grid::Nodes::Centres,
                     .values = scene::reference(*arrays.insert(std::as_bytes(std::span(points))))};
    output.blend = {.left = 200, .right = 200};
    output.color.matrix[0] = {0.9, 0.05, 0.05};
    output.color.gamma = 2.2;
    return output;
}

void set_bytes(benchmark::State& state) {
    state.SetBytesProcessed(static_cast<std::int64_t>(state.iterations() * Values * 3));
}

// Copies as many bytes as an eye's half-float picture and the device's picture have in total.
void plain_copy(benchmark::State& state) {
    std::vector<std::byte> from(3 * Values), to(3 * Values);
    for (auto _ : state) {
        std::memcpy(to.data(), from.data(), from.size());
        benchmark::DoNotOptimize(to.data());
        benchmark::ClobberMemory();
    }
    set_bytes(state);
}
BENCHMARK(plain_copy)->Unit(benchmark::kMillisecond)->UseRealTime();

void run(benchmark::State& state, const Output& output, const scene::BlobStore& arrays, double step) {
    tbb::task_arena arena(static_cast<int>(state.range(0)));
    OutputPipeline pipeline(output, arrays);
    const std::vector<std::uint16_t> halves = picture();
    std::vector<std::uint8_t> device(Values);
    const std::vector<std::span<std::uint8_t>> devices{device};
    const std::vector<EyePicture> eyes(pipeline.eye_count(), eye_picture(halves));
    Head head;
    const auto show = [&] {
        if (!output.points.empty())
            pipeline.set_frustum(view::Eye::Mono, frustum(output.plane, head, view::Eye::Mono, 0.0, 0.0));
        pipeline.run(arena, eyes, devices);
        head.position.x += step;
    };
    show();  // the first allocates and projects the points
    for (auto _ : state) show();
    set_bytes(state);
}

void warped_and_blended(benchmark::State& state) {
    scene::BlobStore arrays;
    const Output output = projector(arrays);
    run(state, output, arrays, 0.0);
}
BENCHMARK(warped_and_blended)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

// As above, for a head that moves with every frame.
void tracked(benchmark::State& state) {
    scene::BlobStore arrays;
    const Output output = projector(arrays);
    run(state, output, arrays, 1e-5);
}
BENCHMARK(tracked)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void colored(benchmark::State& state) {
    Output output{.name = "screen", .width = Width, .height = Height};
    output.color.gamma = 2.2;
    run(state, output, {}, 0.0);
}
BENCHMARK(colored)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void anaglyph(benchmark::State& state) {
    const Output output{.name = "screen", .width = Width, .height = Height, .stereo = Stereo::AnaglyphDubois};
    run(state, output, {}, 0.0);
}
BENCHMARK(anaglyph)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

BENCHMARK_MAIN();

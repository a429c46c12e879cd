// What features cost that a scene does not have: the time of the kernel that it gets over that of one which
// was compiled for its features alone (the promise: 1.02), and of the one with all features.
//   tessera_kernel_bench
// One thread; medians over pairs of pictures that are rendered in turn.
#include <cstdio>

#include "backends/embree/path_tracer.h"
#include "tests/bench/bench_bed.h"
#include "tests/bench/exact_kernels.h"

namespace tessera::embree {
namespace {

constexpr std::uint32_t Size = 128, Rounds = 41;

double time_of(const PathTracer& tracer, std::uint64_t sample) {
    const double start = bench::cpu_seconds();
    std::uint64_t rays = 0;
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < Size * Size; ++i)
        sum += tracer.trace(i % Size, i / Size, sample, rays).low.x;
    if (!(sum >= 0.0f)) std::printf("the picture is no number\n");
    return bench::cpu_seconds() - start;
}

void compare(const bench::Bed& bed, view::Renderer renderer, const char* what, const Kernel& exact_kernel) {
    view::View view = bed.view;
    view.renderer = renderer;
    PathTracer chosen(bed.world.tables(), bed.world.scene(), view);
    PathTracer exact(bed.world.tables(), bed.world.scene(), view);
    PathTracer full(bed.world.tables(), bed.world.scene(), view);
    exact.set_kernel(exact_kernel);
    full.set_kernel(FullKernel);
    std::vector<double> times, chosen_ratios, full_ratios;
    for (std::uint32_t i = 0; i < Rounds; ++i) {
        times.push_back(time_of(exact, i));
        chosen_ratios.push_back(time_of(chosen, i) / times.back());
        full_ratios.push_back(time_of(full, i) / times.back());
    }
    std::printf(
        "  %-8s %5.0f ns per sample; x %.3f by the kernel chosen, x %.3f by the one with all features\n",
        what, 1e9 * bench::median(times) / (Size * Size), bench::median(chosen_ratios),
        bench::median(full_ratios));
}

void run(const char* file, const Kernel& exact) {
    const bench::Bed bed(file, Size);
    const std::uint32_t features = bed.world.tables().scene.features;
    std::printf("%s\n", file);
    if (features != exact.features) {
        std::printf("  has features %x, not %x: its kernel in tests/bench has to follow\n", features,
                    exact.features);
        return;
    }
    compare(bed, view::Renderer::PathTracing, "path", exact);
    compare(bed, view::Renderer::Whitted, "whitted", exact);
}

}  // namespace
}  // namespace tessera::embree

int main() {
    using namespace tessera::embree;
    run("room-1.glb", RoomKernel);
    run("still.glb", StillKernel);
    run("studio-1.glb", StudioKernel);
}

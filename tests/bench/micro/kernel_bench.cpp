// Cost of features that a scene does not use: the time of the chosen kernel over that of one compiled for
// exactly its features (target: 1.02), and the same for the kernel with all features.
//   tessera_kernel_bench
// One thread; medians over pairs of pictures that are rendered in turn. On a busy machine instruction counts
// are more reliable than times; the difference between two runs of
//   valgrind --tool=callgrind tessera_kernel_bench SCENE path|whitted exact|chosen|full PICTURES
// is the count of the additional pictures.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "tests/bench/micro/exact_kernels.h"
#include "tests/bench/micro/rare_feature_scenes.h"
#include "tests/bench/micro/scene_fixture.h"

namespace tessera::embree {
namespace {

constexpr std::uint32_t Size = 128, Rounds = 41;

struct FileScene {
    const char* name;
    const Kernel* exact;
};
const std::vector<FileScene> FileScenes{
    {"room-1", &RoomKernel}, {"still", &StillKernel}, {"studio-1", &StudioKernel}};

void render(const PathTracer& tracer, std::uint64_t sample) {
    std::uint64_t rays = 0;
    float sum = 0.0f;
    for (std::uint32_t i = 0; i < Size * Size; ++i)
        sum += tracer.trace(i % Size, i / Size, sample, rays).low.x;
    if (!(sum >= 0.0f)) std::printf("the picture contains NaN\n");
}

double time_of(const PathTracer& tracer, std::uint64_t sample) {
    const double start = bench::cpu_seconds();
    render(tracer, sample);
    return bench::cpu_seconds() - start;
}

void compare(const SceneAdapter& world, view::View view, view::Renderer renderer, const char* what,
             const Kernel& exact_kernel) {
    view.renderer = renderer;
    PathTracer chosen(world.tables(), world.scene(), view);
    PathTracer exact(world.tables(), world.scene(), view);
    PathTracer full(world.tables(), world.scene(), view);
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
    std::fflush(stdout);
}

// Measures one scene.
using Measure = void (*)(const SceneAdapter& world, view::View view, const Kernel& exact, char** arguments);

void compare_both(const SceneAdapter& world, view::View view, const Kernel& exact, char**) {
    compare(world, view, view::Renderer::PathTracing, "path", exact);
    compare(world, view, view::Renderer::Whitted, "whitted", exact);
}

// renderer, kernel, pictures
void render_some(const SceneAdapter& world, view::View view, const Kernel& exact, char** arguments) {
    const std::string_view kernel = arguments[1];
    view.renderer =
        std::string_view(arguments[0]) == "whitted" ? view::Renderer::Whitted : view::Renderer::PathTracing;
    PathTracer tracer(world.tables(), world.scene(), view);
    if (kernel == "exact") tracer.set_kernel(exact);
    if (kernel == "full") tracer.set_kernel(FullKernel);
    const int pictures = std::atoi(arguments[2]);
    for (int i = 0; i < pictures; ++i) render(tracer, static_cast<std::uint64_t>(i));
}

void run(const char* name, const SceneAdapter& world, const view::View& view, const Kernel& exact,
         Measure measure, char** arguments) {
    const std::uint32_t features = world.tables().scene.features;
    std::printf("%s\n", name);
    if (features != exact.features) {
        std::fprintf(stderr, "%s has features %x, not %x: update its kernel in tests/bench/micro\n", name,
                     features, exact.features);
        std::exit(EXIT_FAILURE);
    }
    measure(world, view, exact, arguments);
}

// All scenes, or the one of this name.
void run_scenes(std::string_view only, Measure measure, char** arguments) {
    for (const FileScene& scene : FileScenes) {
        if (!only.empty() && only != scene.name) continue;
        const bench::SceneFixture fixture(std::string(scene.name) + ".glb", Size);
        run(scene.name, fixture.world, fixture.view, *scene.exact, measure, arguments);
    }
    for (const RareFeatureScene& scene : rare_feature_scenes()) {
        if (!only.empty() && only != scene.name) continue;
        Model model;
        scene.add(model);
        run(scene.name, model.build(), rare_feature_view(Size), *scene.exact, measure, arguments);
    }
}

}  // namespace
}  // namespace tessera::embree

int main(int count, char** arguments) {
    using namespace tessera::embree;
    if (count == 5) {
        run_scenes(arguments[1], render_some, arguments + 2);
    } else if (count == 1) {
        run_scenes({}, compare_both, nullptr);
    } else {
        std::fprintf(stderr, "usage: tessera_kernel_bench [SCENE path|whitted exact|chosen|full PICTURES]\n");
        return 2;
    }
}

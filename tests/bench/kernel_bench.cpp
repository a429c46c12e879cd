#include <algorithm>
#include <cstdio>
#include <ctime>

#include "backends/embree/path_tracer.h"
#include "backends/embree/world.h"
#include "client/import/import.h"

namespace tessera::embree {
extern const Kernel ExactKernel;
namespace {

constexpr std::uint32_t Size = 128;

double cpu_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
}

struct Bed {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    DeviceHandle device = make_device({.threads = 1, .blobs = blobs});
    World world{device.get(), blobs};
    view::View view;

    explicit Bed(const std::string& file) {
        auto imported = import::import_scene(file, {});
        if (!imported) throw imported.error();
        for (const auto& blob : imported->blobs) blobs->insert(blob);
        scene::Scene scene;
        if (auto applied = scene.apply_entries(import::entries(*imported, import::RootEntry::Create));
            !applied)
            throw applied.error();
        scene.set_version({1, 1});
        if (auto applied = world.apply(scene::snapshot(scene)); !applied) throw applied.error();
        if (auto committed = world.commit(); !committed) throw committed.error();
        const auto& camera = imported->cameras.at(0);
        view.width = view.height = Size;
        view.camera = view::perspective(camera.world_from_camera, camera.camera.vertical_fov, 1.0);
        view.channels = {frame::Channel::Radiance};
    }
};

double time_of(const PathTracer& tracer, std::uint64_t sample) {
    const double start = cpu_seconds();
    std::uint64_t rays = 0;
    float sum = 0;
    for (std::uint32_t y = 0; y < Size; ++y)
        for (std::uint32_t x = 0; x < Size; ++x) sum += tracer.trace(x, y, sample, rays).low.x;
    volatile float keep = sum;
    (void)keep;
    return cpu_seconds() - start;
}

double median(std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
}

void compare(const Bed& bed, view::Renderer renderer, const char* name) {
    view::View view = bed.view;
    view.renderer = renderer;
    PathTracer exact(bed.world.tables(), bed.world.scene(), view), full(bed.world.tables(), bed.world.scene(), view), chosen(bed.world.tables(), bed.world.scene(), view);
    exact.set_kernel(ExactKernel);
    full.set_kernel(FullKernel);
    std::vector<double> fulls, choices, exacts;
    for (int i = 0; i < 40; ++i) {
        const double e = time_of(exact, i);
        const double f = time_of(full, i);
        const double c = time_of(chosen, i);
        fulls.push_back(f / e);
        choices.push_back(c / e);
        exacts.push_back(e);
    }
    std::printf("%s: exact %.0f ns/sample; full %.4f, chosen(%x) %.4f\n", name, median(exacts) / Size / Size * 1e9, median(fulls), chosen.kernel().features, median(choices));
}

}  // namespace
}  // namespace tessera::embree

int main(int argc, char** argv) {
    using namespace tessera;
    for (int i = 1; i < argc; ++i) {
        const embree::Bed bed(argv[i]);
        std::printf("%s features %x (exact has %x)\n", argv[i], bed.world.tables().scene.features.bits, embree::ExactKernel.features);
        if (bed.world.tables().scene.features & ~embree::ExactKernel.features) continue;
        embree::compare(bed, view::Renderer::PathTracing, "path");
        embree::compare(bed, view::Renderer::Whitted, "whitted");
    }
}

#pragma once

#include <functional>

#include "backends/embree/path_tracer.h"
#include "backends/embree/scene_adapter.h"
#include "tests/statistics/scene_model.h"

namespace tessera::embree {

using test::chalk, test::glass, test::lamp, test::mirror, test::Normals, test::small_view;

// A scene put together in a test, drawn by Embree.
class Model : public test::SceneModel {
  public:
    using SceneModel::SceneModel;

    // Once.
    SceneAdapter& build() {
        EXPECT_TRUE(world_.apply(scene::snapshot(finished())));
        const auto report = world_.commit();
        EXPECT_TRUE(report);
        if (report) problems = report->problems;
        return world_;
    }

    std::vector<std::string> problems;  // of the build

  private:
    DeviceHandle device_ = make_device({.threads = 1, .blobs = blobs()});
    SceneAdapter world_{device_.get(), blobs()};
};

// Every sample of a view, in order.
inline void for_samples(const SceneAdapter& world, const view::View& view, std::uint64_t spp,
                        const std::function<void(const PathSample&)>& visit) {
    const PathTracer tracer(world.tables(), world.scene(), view);
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < spp; ++sample) {
        for (std::uint32_t y = 0; y < view.height; ++y) {
            for (std::uint32_t x = 0; x < view.width; ++x) visit(tracer.trace(x, y, sample, rays));
        }
    }
}

struct Mean {
    double value = 0, standard_error = 0;
};
inline Mean mean_of(const SceneAdapter& world, const view::View& view, std::uint64_t spp,
                    const std::function<double(const PathSample&)>& what) {
    double sum = 0, squares = 0, n = 0;
    for_samples(world, view, spp, [&](const PathSample& sample) {
        const double value = what(sample);
        sum += value;
        squares += value * value;
        ++n;
    });
    const double mean = sum / n;
    return {mean, std::sqrt(std::max(0.0, squares / n - mean * mean) / n)};
}

inline double red(const PathSample& sample) {
    return double(radiance_of(sample).x);
}

}  // namespace tessera::embree

#pragma once

#include "tests/bench/micro/timing.h"
#include "tests/statistics/model.h"

// Renders a model with its own tables or with modified ones, on one thread of Embree.
namespace tessera::bench {

// Mean red of each pixel.
inline std::vector<double> picture(const embree::SceneAdapter& world, const backend::SceneTables& tables,
                                   view::View view, std::uint64_t spp, std::uint64_t seed) {
    view.seed = seed;
    const embree::PathTracer tracer(tables, world.scene(), view);
    std::vector<double> pixels(std::size_t{view.width} * view.height);
    std::uint64_t rays = 0;
    for (std::uint64_t sample = 0; sample < spp; ++sample) {
        for (std::uint32_t i = 0; i < pixels.size(); ++i) {
            pixels[i] += embree::red(tracer.trace(i % view.width, i / view.width, sample, rays)) /
                         static_cast<double>(spp);
        }
    }
    return pixels;
}

// Nanoseconds per sample.
inline double time_of(const embree::SceneAdapter& world, const backend::SceneTables& tables,
                      const view::View& view, std::uint64_t spp) {
    const double start = cpu_seconds();
    const std::size_t pixels = picture(world, tables, view, spp, 5).size();
    return (cpu_seconds() - start) / double(spp * pixels) * 1e9;
}

}  // namespace tessera::bench

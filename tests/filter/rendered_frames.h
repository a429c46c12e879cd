#pragma once

#include <tbb/task_arena.h>

#include <string>

#include "tests/bench/filters/sampler.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {

// A scene of the benchmarks, rendered in this process by Embree with the production sampler.
class RenderedScene {
  public:
    // `name`: of a built-in scene, or of a file in tests/scenes.
    RenderedScene(const std::string& name, std::uint32_t width, std::uint32_t height);

    // The whole film of samples [0, spp) with this seed, as the first of its film.
    Inputs frame(std::uint64_t seed, std::uint64_t spp = 1,
                 view::PathClass path_class = view::PathClass::Diffuse) const;
    // Radiance of so many samples, 3 components.
    Planes reference(std::uint64_t seed, std::uint64_t spp) const;

  private:
    frame::FilmTile film(const view::View& view, std::uint64_t spp) const;

    std::uint32_t width_, height_;
    mutable tbb::task_arena arena_{2};
    tools::bench::Sampler sampler_;
};

// Structural similarity and mean squared error of the colours, without alpha.
double ssim(const Planes& picture, const Planes& reference);

// Of the radiance of several films with equal counts: what a renderer without a filter shows after them.
class UnfilteredMean {
  public:
    void add(const Inputs& frame);
    Planes picture() const;

  private:
    Planes sum_;
    double frames_ = 0.0;
};

}  // namespace tessera::filter

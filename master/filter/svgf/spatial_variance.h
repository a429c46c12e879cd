#pragma once

#include "master/filter/svgf/accumulate.h"
#include "master/filter/svgf/guides.h"

namespace tessera::filter::svgf {

// The initial variance of the wavelet transform, written to component 3 of the state's colour: of the mean or
// of one sample (EdgeStops::deviation); from the samples of the pixel, or from its neighbourhood if it has
// fewer than `young` (E-D16: moments under a Gaussian of 7x7 on the same surface, computed as a row and a
// column pass); then blurred by (1 2 1)x(1 2 1)/16 (E-D7), if asked for.
class SpatialVariance {
  public:
    // False: stopped.
    bool run(const Guides& guides, const EdgeStops& stops, float young, bool blurs, State& state,
             RunContext& context);

  private:
    bool estimate(const Guides& guides, const EdgeStops& stops, float young, const State& state,
                  RunContext& context);
    void sum_along(const Guides& guides, const EdgeStops& stops, const State& state, std::uint32_t y);
    void sum_across(const Guides& guides, const EdgeStops& stops, float young, const State& state,
                    std::uint32_t y);

    Planes raw_;   // 1: before the blur
    Planes sums_;  // inputs of the spatial estimate per pixel, and its sums along the row
    std::vector<std::uint8_t> young_rows_;
};

}  // namespace tessera::filter::svgf

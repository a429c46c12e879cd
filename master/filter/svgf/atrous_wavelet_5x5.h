#pragma once

#include "master/filter/svgf/guides.h"
#include "master/filter/svgf/padded_planes.h"

namespace tessera::filter::svgf {

inline constexpr std::uint32_t MaxLevels5x5 = 6;  // two of the widest steps are the margin of PaddedPlanes

// As AtrousWavelet, with the 5x5 taps (1 4 6 4 1)x(1 4 6 4 1)/256 of the original SVGF (Schied et al. 2017): 24 weighted
// taps instead of 8. For comparison: 6 levels of 3x3 blur more, with a deviation of 26.1 px instead of 18.5 for 5 levels. The own
// weight is a lower bound: one step of a level is two of the finer one.
class AtrousWavelet5x5 {
  public:
    // Levels below MaxLevels5x5. False: stopped.
    bool run(const Guides& guides, const EdgeStops& stops, std::uint32_t level, const PaddedPlanes& from,
             PaddedPlanes& to, RunContext& context);

  private:
    std::vector<float> scratch_;  // per thread
};

}  // namespace tessera::filter::svgf

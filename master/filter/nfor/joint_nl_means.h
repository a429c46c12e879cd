#pragma once

#include "master/filter/kernels.h"
#include "master/filter/nfor/patch_distance.h"
#include "master/filter/nfor/per_thread.h"

namespace tessera::filter::nfor {

// NL-means of some planes with weights from a guide, exp(-max(0, D) / k^2), over known pixels:
//
//     out(p) = sum w(p, q) v(q) / sum w(p, q)
//
// A pixel without known pixels in its window keeps its value.
class JointNlMeans {
  public:
    // `values` has 1 to 3 components; `out` gets its shape and may not be the same. False: stopped.
    bool run(const Guide& guide, const Planes& values, const PatchSettings& settings, float k, Planes& out,
             RunContext& context);

    static constexpr std::uint32_t MaxComponents = 3;

  private:
    struct Slot {
        PatchDistance distance;
        std::vector<float> distances, window, sums;
    };
    void run_tile(const Tile& tile, const Guide& guide, const Planes& values, const PatchSettings& settings,
                  float k, Planes& out, Slot& slot) const;

    PerThread<Slot> slots_;
};

}  // namespace tessera::filter::nfor

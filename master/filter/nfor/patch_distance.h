#pragma once

#include <span>
#include <vector>

#include "master/filter/tiles.h"

namespace tessera::filter::nfor {

// Guide that patches are compared by: values with variances, 1 or 3 components. known: 0 for unknown pixels.
struct Guide {
    const Planes& values;
    const Planes& variances;
    const Planes& known;
};

struct PatchSettings {
    std::uint32_t radius, patch;  // of the window, of the patches in it
};
inline constexpr std::uint32_t MaxRadius = 10, MaxPatch = 3;

// Distances of patches around the pixels of one tile to patches at an offset (Rousselle et al. 2012):
//
//     D(p, q) = mean over the patch and the components of
//               ((a - b)^2 - (V_a + min(V_a, V_b))) / (V_a + V_b),    cut at 1e6
//
// to be used as exp(-max(0, D) / k^2). A pair with an unknown pixel, or one out of the picture, carries no
// information and counts 0, the expectation for equal pixels.
class PatchDistance {
  public:
    // Allocates for guides of so many components.
    void reserve(const PatchSettings& settings, std::uint32_t components);
    // With the settings of reserve().
    void load(const Guide& guide, const Tile& tile);

    // Of every step-th row of the tile, each Tiles::Width long, to offset (dx, dy) within the radius.
    void compute(std::int32_t dx, std::int32_t dy, std::uint32_t step, float* to);

  private:
    template <std::uint32_t Components>
    void pairs(std::int32_t dx, std::int32_t dy);

    PatchSettings settings_{};
    std::uint32_t components_ = 0, height_ = 0, halo_ = 0;
    std::size_t columns_ = 0, plane_ = 0;
    std::vector<float> window_;  // known, then value and variance per component
    std::vector<float> pairs_, column_sums_;
};

}  // namespace tessera::filter::nfor

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
    // The values are means of two halves with noise that neighbours share, as a filter leaves it. `variances` are
    // not variances but half the difference of the halves (for halves of different size, that difference times
    // sqrt(n_A n_B) / n).
    bool correlated = false;
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
// or, with correlated noise and e the half difference, whose change from a to b is an estimate of the noise of a - b,
//
//     D(p, q) = sum (a - b)^2 / sum (e_a - e_b)^2 - 1        both over the patch and the components
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
    // Squares of differences and their noise, for correlated guides.
    void correlated_pairs(std::int32_t dx, std::int32_t dy);
    void compute_correlated(std::uint32_t step, float* to);

    PatchSettings settings_{};
    std::uint32_t components_ = 0, height_ = 0, halo_ = 0;
    std::size_t columns_ = 0, plane_ = 0;
    std::vector<float> window_;  // known, then value and variance per component
    std::vector<float> pairs_, column_sums_;
    std::vector<float> noise_, noise_sums_;
    bool correlated_ = false;
};

}  // namespace tessera::filter::nfor

#pragma once

#include <vector>

#include "master/filter/features.h"
#include "mediator/filter/filter.h"

namespace tessera::filter {

struct LocalModelSettings {
    std::uint32_t radius = 4;
    float ridge = 1e-3f;  // added to the variances of the guides; above 0
};

// The two steps of the guided filter: a linear model of `color` in GuideCount guides for the square around
// every pixel, from the pixels that are known, and the mean of the models around a pixel applied to its
// guides. Where a square has no known pixel its model is the pixel's own colour.
//
// Squares are cut at the borders. Works in strips of rows, so that the models of a whole frame are never in
// memory, and within them in small tiles, whose 36 + 8 x components sums stay in the second-level cache.
class LocalModels {
  public:
    // Guides with a variance of order 1; colours within 1e30. False: stopped.
    bool run(const Planes& guides, const Planes& color, const Planes& known,
             const LocalModelSettings& settings, Planes& out, RunContext& context);

  private:
    static constexpr std::size_t Width = 64, Height = 32;  // of a tile
    static constexpr std::int64_t Strip = 4 * Height;

    struct Frame;  // the inputs of a run
    struct Space {
        std::vector<float> values, between, sums;  // a tile with its margin; sums over rows; all sums
        std::vector<float> source;  // known, guides and colours of a tile with its surroundings
    };

    struct Tile;
    template <std::uint32_t Components>
    struct Origins;

    template <std::uint32_t Components>
    bool run(const Frame& frame, RunContext& context);
    // The steps of fit: a tile's values, the sums of their products over squares, the models from the sums.
    template <std::uint32_t Components>
    static void load(const Frame& frame, const Tile& tile, Space& space, Origins<Components>& origins);
    template <std::uint32_t Components>
    static void sum_products(const Tile& tile, Space& space);
    template <std::uint32_t Components>
    void solve(const Frame& frame, const Tile& tile, const Space& space, const Origins<Components>& origins,
               std::int64_t y);
    template <std::uint32_t Components>
    void fit(const Frame& frame, std::int64_t left, std::int64_t top, std::int64_t bottom, Space& space);
    template <std::uint32_t Components>
    void apply(const Frame& frame, std::int64_t left, std::int64_t top, std::int64_t bottom, Space& space);
    float* model_row(const Frame& frame, std::uint32_t number, std::int64_t y);

    std::vector<Space> spaces_;  // one per thread of the arena
    std::vector<float> models_;  // ring buffer of rows: as many as a strip reads
};

}  // namespace tessera::filter

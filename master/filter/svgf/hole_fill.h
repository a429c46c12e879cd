#pragma once

#include <span>
#include <vector>

#include "master/filter/svgf/guides.h"

namespace tessera::filter::svgf {

// A plane to fill.
struct PlaneView {
    float* values;
    std::size_t pitch;
    float* row(std::size_t y) const { return values + y * pitch; }
};

// Fills pixels without a sample from a pyramid of factor 3 (Dundr 2.7.1): a coarse texel is the mean of the
// valid children that show the same object as the one next to its centre, weighted by samples; a hole takes
// the finest level with valid texels around it, with linear interpolation among texels of one object.
class HoleFill {
  public:
    // Sets ids of holes and every view's values there. Unchanged if there are no samples at all. False:
    // stopped.
    bool run(const Planes& counts, std::vector<std::uint32_t>& ids, std::span<const PlaneView> planes,
             RunContext& context);

  private:
    struct Level {
        std::uint32_t width = 0, height = 0;
        std::vector<float> texels;  // weight, then a value per plane
        std::vector<std::uint32_t> ids;
    };

    // Both: false when stopped.
    template <class Fine>
    static bool reduce_to(Level& level, const Fine& fine, std::size_t size, RunContext& context);
    bool build_pyramid(const Planes& counts, const std::vector<std::uint32_t>& ids,
                       std::span<const PlaneView> planes, RunContext& context);
    // One hole; false: the level has no valid texels around it. `scale`: texels per pixel.
    static bool fill_from(const Level& level, float scale, std::uint32_t x, std::uint32_t y,
                          std::uint32_t& id, std::span<const PlaneView> planes);

    std::vector<Level> levels_;  // finest first; kept to reuse their memory
    std::size_t used_ = 0;       // levels in use, up to the first without holes
};

}  // namespace tessera::filter::svgf

#pragma once

#include <cstdint>
#include <vector>

#include "master/filter/svgf/guides.h"
#include "master/filter/svgf/padded_planes.h"

namespace tessera::filter::svgf {

enum class LevelOrder : std::uint8_t {
    // 0, 5, 4, 3, 2, 1, 0: coarse levels leave lattices that finer ones remove. Between the first and the last pass even and
    // odd pixels do not mix: without the last one, bright finds leave dots two pixels apart.
    BothEnds,
    FirstThenCoarse,  // 0, 5, 4, 3, 2, 1 (Dundr)
    Fine,             // 0 .. 5
    Coarse,           // 5 .. 0
};

inline constexpr std::uint32_t MaxLevels = 7;  // the margin of PaddedPlanes is the widest step

std::uint32_t pass_count(std::uint32_t levels, LevelOrder order);
// The level of a pass, of so many levels.
std::uint32_t level_of(std::uint32_t pass, std::uint32_t levels, LevelOrder order);

// One level of the edge-stopping stationary wavelet transform (E-D8, E-D12): 3x3 taps (1 2 1)x(1 2 1)/16,
// 2^level pixels apart. The variance is propagated with squared weights (E-D13). The own weight is multiplied by the
// centre's: no sum of different steps leads back to the pixel. (Of two passes of level 0 it is a lower bound.)
class AtrousWavelet {
  public:
    // `from` and `to` are SignalComponents of the guides' size, and not the same. False: stopped.
    bool run(const Guides& guides, const EdgeStops& stops, std::uint32_t level, const PaddedPlanes& from,
             PaddedPlanes& to, RunContext& context);

    // Read: the signal, normals, inverse depth, slopes, ids; written: the signal.
    static constexpr double BytesPerPixel = 4.0 * (5 + 3 + 1 + 2 + 1 + 5);

  private:
    struct Scratch;
    std::vector<float> scratch_;  // per thread
};

}  // namespace tessera::filter::svgf

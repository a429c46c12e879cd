#pragma once

#include <bit>
#include <cstdint>
#include <span>

// When the pixel filter runs while samples arrive (Schwenk 3.3.3): a wide filter changes little from one
// sample to the next, so it runs at 4, 8, 16, 32, ... samples and pictures in between are only re-blended.
namespace tessera::filter::pixel {

inline constexpr std::uint64_t FirstPass = 4;

// A power of two of at least FirstPass lies in (last, samples]. `last`: samples at the last pass, 0 before
// it.
inline bool filter_due(std::uint64_t samples, std::uint64_t last) {
    return samples >= FirstPass && std::bit_floor(samples) > last;
}

// The median of the counts of about 4096 pixels on a regular grid over the raster (all of a small picture):
// the equivalent of the thesis' "frame n" when counts differ between pixels. 0 for no pixels.
std::uint64_t median_count(std::span<const float> counts);

}  // namespace tessera::filter::pixel

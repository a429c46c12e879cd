#pragma once

#include <tbb/task_arena.h>

#include <array>
#include <span>

#include "mediator/filter/planes.h"

namespace tessera::master {

// One picture among those that make a view, with planes in raster order, all of one size.
struct Layer {
    std::array<std::span<const float>, 3> color;  // premultiplied by alpha; finite
    std::span<const float> alpha;                 // counts as clamped to [0, 1]
    std::span<const float> depth;                 // +inf where nothing is; what is no number counts as that
};

inline constexpr std::size_t MaxLayers = 16;

// Lays pictures over each other by depth and alpha (Schwenk F55): in every pixel the nearest lies on top, of
// equally near ones the later in the list, each covers what is below by its alpha (Porter and Duff 1984,
// "over"). What lies below an alpha of 1 leaves no trace, so a pixel of one opaque layer keeps its bits.
// `out` becomes r, g, b, alpha, premultiplied, and keeps its memory from picture to picture; finite, whatever
// the depths: sums beyond the range of floats end at its end. Uses all of the arena. Throws
// Error{InvalidInput} for no layer, more than MaxLayers, or planes that are not of width x height.
void compose(std::span<const Layer> layers, std::uint32_t width, std::uint32_t height, filter::Planes& out,
             tbb::task_arena& arena);

}  // namespace tessera::master

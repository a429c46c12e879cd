#pragma once

#include <tbb/task_arena.h>

#include <array>
#include <span>

#include "mediator/filter/planes.h"

namespace tessera::master {

// One compositing layer of a view, with planes in raster order, all of the same size.
struct Layer {
    std::array<std::span<const float>, 3> color;  // premultiplied by alpha; finite
    std::span<const float> alpha;                 // clamped to [0, 1]
    std::span<const float> depth;                 // +inf for the background; NaN counts as +inf
};

inline constexpr std::size_t MaxLayers = 16;

// Composites layers by depth and alpha (Schwenk F55): in every pixel the nearest is on top, of equally near ones the
// later in the list; each covers those below by its alpha (Porter and Duff 1984, "over"). A layer below an alpha of 1
// contributes nothing, so a pixel of one opaque layer is unchanged bit by bit. `out` becomes r, g, b, alpha,
// premultiplied, and its memory is reused; always finite: sums are clamped to the range of floats. Uses all of the arena. Throws
// Error{InvalidInput} for no layer, more than MaxLayers, or planes that are not of width x height.
void compose(std::span<const Layer> layers, std::uint32_t width, std::uint32_t height, filter::Planes& out,
             tbb::task_arena& arena);

}  // namespace tessera::master

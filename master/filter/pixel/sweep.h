#pragma once

#include "master/filter/pixel/field.h"

namespace tessera::filter::pixel {

enum class Direction { Rows, Columns };
enum class Edges { Keep, Recover };  // Recover: antialiased pixels between two regions, see edge_model.h

// One one-dimensional cross-bilateral filter over the picture.
struct Sweep {
    Direction direction = Direction::Rows;
    float width_factor = 1.0f;  // of the pixel's width: sigma of this sweep
    std::int64_t spacing = 1;   // in pixels
    Sources sources = Sources::All;
    Edges edges = Edges::Keep;
};

// Scratch of sweeps over columns, one per thread of an arena; kept between sweeps.
using Strips = std::vector<std::vector<float>>;

// Filters `from` into `to`, cut at 3 sigma of the widest of eight neighbouring pixels. r of the result is the
// sum of squared weights times r of the inputs. Fields of 2 to 6 components. Pixels without similar
// neighbours keep their values. False: stopped.
bool sweep(const Guide& guide, const Widths& widths, const Sweep& plan, const Field& from, Field& to,
           Strips& strips, RunContext& context);

// The iterated separable filter (Schwenk 3.6.1): rows and columns in turn, `iterations` times with shrinking
// kernels (3.14). Every iteration starts with the direction that the previous one ended with, which removes
// its streaks. The result is in `field`; its r is that of the first iteration times reduction_ratio: later
// iterations filter data that are no longer independent.
bool filter_separable(const Guide& guide, const Widths& widths, int iterations, Edges edges, Field& field,
                      Field& scratch, Strips& strips, RunContext& context);

}  // namespace tessera::filter::pixel

#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Half the size, rounded up: a pixel is the mean of 6 x 6 with the weights of a Gauss of sigma 0.55 sqrt(4 -
// 1) (Lardinoije 2.1), around the centre of its four; the border is repeated. `out` gets its shape.
void halve(const Planes& in, Planes& out, RunContext& context);

// The same for variances of means of independent pixels: the weights are squared.
void halve_variance(const Planes& in, Planes& out, RunContext& context);

// to += up(from - halved), bilinear. With halved = halve(to): the low frequencies of `to` become those of
// `from`.
void add_difference(const Planes& from, const Planes& halved, Planes& to, RunContext& context);

}  // namespace tessera::filter

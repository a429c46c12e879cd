#pragma once

#include "mediator/frame/film_tile.h"

namespace tessera::frame {

// Writes one sample (block of level 0) of one pixel: `values` holds the components of every channel of the tile that has
// values, in the order of the enum. Radiance that is not finite rejects the whole sample: it is counted in nonfinite_samples,
// never merged. In other channels a value that is not finite counts as that of a miss, so that radiance does not
// depend on which channels are asked for; an infinite depth is legal.
void put_sample(FilmTile& tile, std::size_t pixel, std::span<const float> values);

// into := merge(into, later). Both cover the same rect, pixels and channels; `later` starts where `into` ends or anywhere
// after it. Siblings with equal counts need no division: mean = (a + b) / 2, M2 = M2a + M2b + (a - b)^2 n / 2 with n
// samples in each half; other counts use the general form (Chan et al. 1979). This is the only
// implementation, compiled once without contraction, so that node and master get the same bits.
//
// BlockVariance: with means a and b of siblings, sum over r, g, b of w (a - b)^2 / 4 with the weights w of luminance, or
// times na nb / n^2 with differing counts: in expectation the variance of the mean of independent samples, and no less than
// it if halves are negatively correlated, as in stratified sequences. Roots that are no siblings have independent errors,
// weighted by the squares of their shares; that of a single sample is unknown, and taken to be that of a sample of the other
// root.
void merge(FilmTile& into, const FilmTile& later);

// The numeric core, exposed for tests; `Real` is float in a film and double as the reference.
template <class Real>
struct Moments {
    std::uint64_t n = 0;
    Real mean = 0, m2 = 0;
};
template <class Real>
Moments<Real> merged(const Moments<Real>& a, const Moments<Real>& b);

}  // namespace tessera::frame

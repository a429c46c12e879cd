#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// The weight that a filtered picture F gives to the noise of each pixel's own samples U, from what became of a known
// change of all pixels at once, u of U and f of F, whose covariance is that of the noise:
//
//     a = sum u f / S^2 / sum u^2 / S^2        over 11 x 11 pixels
//
// cut to [0, 1], where S is the brightness of F plus a tenth of its mean. That is what ConvergenceBlend needs: with it
// the variance of U times 1 - a is the covariance of U and U - F. Filter weights that follow the noise of U itself
// count, too. Changes of neighbours are independent, so that what they do to F is noise around 0. Pixels with u = f = 0
// do not count; where there are no others, a = 0.
class SelfWeight {
  public:
    // `change`: u before it is multiplied by `scale`, or without one if that is empty, and `response`: f, both summed
    // over r, g, b. False: stopped.
    bool run(const Inputs& inputs, std::span<const float> change, std::span<const float> scale,
             std::span<const float> response, const Planes& filtered, RunContext& context);

    std::span<const float> weights() const { return weights_.plane(0); }

  private:
    Planes sums_, weights_;  // of covariance and variance along rows
};

}  // namespace tessera::filter

#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter::nfor {

// The weight that a filtered picture F gives to the noise of each pixel's own samples U, from what both halves of the
// samples became. With n samples in all and s = sqrt(n_A n_B) / n, noise of the halves has the same covariance in
// s (U_A - U_B) and s (F_A - F_B) as in U and F:
//
//     a = sum s^2 (U_A - U_B) (F_A - F_B) / S^2 / sum s^2 (U_A - U_B)^2 / S^2        over 11 x 11 pixels
//
// cut to [0, 1], with the differences summed over r, g, b and S the brightness of F plus a tenth of its mean. That is
// what ConvergenceBlend needs: with it the variance of U times 1 - a is the covariance of U and U - F. Filter weights
// that follow the noise of U itself count, too. A pixel whose halves are equal everywhere around it has a = 0.
class SelfWeight {
  public:
    // `colors`: the means of both halves. `scale`: s. `change`: s (F_A - F_B) summed over r, g, b. False: stopped.
    bool run(const Inputs& inputs, const std::array<Planes, 2>& colors, const Planes& scale,
             std::span<const float> change, const Planes& filtered, RunContext& context);

    std::span<const float> weights() const { return weights_.plane(0); }

  private:
    Planes sums_, weights_;  // of covariance and variance along rows
};

}  // namespace tessera::filter::nfor

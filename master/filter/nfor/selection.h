#pragma once

#include "master/filter/nfor/collaborative.h"

namespace tessera::filter::nfor {

// Selects the reconstruction with less error, using samples that neither was made from: a half A filtered
// with bandwidth k has the error (A_k - b)^2 - Var b against the other half's mean b, and the same with the
// halves exchanged. The result is the mean of A_k and B_k, whose error is that less (A_k - B_k)^2 / 4. The
// variances of a and b cancel in the difference of two k. That difference, relative to the picture, is
// filtered by NL-means; its sign is the selection, and the selection is filtered again (Bitterli et al. 2016,
// section 5).
class Selection {
  public:
    // filtered[h][k]: half h, bandwidth k. False: stopped.
    bool run(const Inputs& inputs, const std::array<Half, 2>& halves,
             const std::array<std::array<Planes, 2>, 2>& filtered, RunContext& context);

    // Weight of Bandwidths[0] in the result, in [0, 1].
    const Planes& first() const { return first_; }

  private:
    JointNlMeans nl_means_;
    Planes guide_, variance_, advantage_, smooth_, chosen_, first_;
};

}  // namespace tessera::filter::nfor

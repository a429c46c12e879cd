#pragma once

#include "master/filter/kernels.h"

namespace tessera::filter {

// Variances of the means of a channel (3 components, Moments) that are reliable with few samples. A pixel whose samples
// happen to be equal has an estimated variance of 0 without being exact; so each pixel's estimate is moderated by that of
// its neighbourhood (the posterior mean of a scaled inverse chi-square prior, as in moderated t-tests; Smyth 2004):
//
//     V(p) = ((n - 1) V_own + k V_0) / (n - 1 + k),     degrees of freedom n - 1 + k
//     V_0  = S_0 / n,   S_0 = sum((n - 1) n V_own) / sum(n - 1) over a square, the variance of one sample
//
// The weight of the neighbourhood goes to 0 with 1 / n. Where no pixel of the square has two samples, V_0 is
// the spatial variance of the means of one sample. A hole (n = 0) has V = 0 and 0 degrees of freedom.
class ModeratedVariance {
  public:
    // `channel`: Radiance or Root. k >= 0 degrees of freedom given to the neighbourhood, a square of (2 radius + 1)^2
    // pixels. With k = 0, n = 1 still takes V_0, with 1 degree of freedom. False: stopped.
    bool run(const Inputs& inputs, float k, std::uint32_t radius, RunContext& context,
             frame::Channel channel = frame::Channel::Radiance);

    const Planes& variance() const { return variance_; }  // r, g, b
    const Planes& dof() const { return dof_; }

    // Memory traffic of run() per pixel.
    static constexpr double Bytes = 4.0 * (1 + 3 + 3 + 4);

  private:
    Planes variance_, dof_;
};

}  // namespace tessera::filter

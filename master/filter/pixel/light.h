#pragma once

#include "master/filter/pixel/field.h"

namespace tessera::filter::pixel {

// The light of an input: what is filtered and what is not. A film without HighVariance counts all of its
// radiance as of high variance, without LowVariance what is left of the radiance as of low.
//
// The filter knows one variance per pixel, that of the luminance Y = sum of w_c L_c (the thesis keeps one
// float and does not say which). The film has no covariances of channels, but they are at most sd_c sd_d, so
//
//     Var[Y] <= (sum of w_c sd_c)^2
//
// is what is taken: exact where light differs in brightness alone, too large otherwise, up to 2.1 times for
// independent channels of equal variance. A single sample has no variance; there Y^2 stands for it, whose
// expectation Var[Y] + E[Y]^2 is not below.
class Light {
  public:
    // Keeps references to `inputs` where it can, copies where pixels are holes or channels are missing.
    void prepare(const Inputs& inputs, const Holes& holes, RunContext& context);

    // What is filtered: values within +-1e30, so that weighted sums are finite; r = 1. Holes have what their
    // origin has.
    void fill(const Inputs& inputs, const Holes& holes, Field& field, RunContext& context) const;

    const Planes& low() const { return *low_; }    // 3 components
    const Planes& high() const { return *high_; }  // 3 components

  private:
    const Planes* low_ = nullptr;
    const Planes* high_ = nullptr;
    Planes own_low_, own_high_;
};

// Variance of the luminance of the mean, as Light::fill takes it, from those of the channels.
inline float luminance_variance(float r, float g, float b) {
    const float deviation = luminance(std::sqrt(r), std::sqrt(g), std::sqrt(b));
    return deviation * deviation;
}

}  // namespace tessera::filter::pixel

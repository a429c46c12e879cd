#pragma once

#include "master/filter/pixel/field.h"

namespace tessera::filter::pixel {

// The high-variance light, or all.
enum class LightScope { PathClass, All };

// The filtered and unfiltered light of an input. Without HighVariance all radiance counts as high-variance;
// without LowVariance the rest of the radiance counts as low-variance.
//
// The filter knows one variance per pixel, that of the luminance Y = sum of w_c L_c (the thesis keeps one
// float without defining it). The film has no covariances of colour channels, but they are at most sd_c sd_d,
// so
//
//     Var[Y] <= (sum of w_c sd_c)^2
//
// is used: exact where light differs in brightness alone, otherwise too large, by up to 2.1 for independent
// colour channels of equal variance. For a single sample, Y^2 is used, whose expectation Var[Y] + E[Y]^2 is
// an upper bound.
class Light {
  public:
    // Keeps references to `inputs` where it can, copies where there are holes or channels are missing.
    void prepare(const Inputs& inputs, const Holes& holes, LightScope which, RunContext& context);

    // The filtered light: values within +-1e30, so that weighted sums are finite; r = 1. Holes take the
    // values of their origin. The variance is that of the mean; where counts differ, `field` is weighted.
    void fill(const Inputs& inputs, const Holes& holes, Field& field, RunContext& context) const;

    // Ends the weighting of a filtered field, except for its last component. r is that of the pixel's own
    // variance, at most 1. The variance is that of one sample. Nothing to do where counts are equal.
    void divide_by_counts(const Inputs& inputs, const Holes& holes, Field& field, RunContext& context) const;

    const Planes& low() const { return *low_; }    // 3 components
    const Planes& high() const { return *high_; }  // 3 components

    frame::Channel channel() const { return channel_; }  // of high(), with its variance

    // Pixels with samples do not all have as many.
    bool has_uneven_counts() const { return least_count_ < largest_count_; }

  private:
    void weigh(const Inputs& inputs, const Holes& holes, std::uint32_t y, Field& field) const;

    const Planes* low_ = nullptr;
    const Planes* high_ = nullptr;
    frame::Channel channel_ = frame::Channel::Radiance;
    Planes own_low_, own_high_;
    float least_count_ = 0.0f, largest_count_ = 0.0f;  // of pixels with samples
};

// Variance of the luminance of the mean, as in Light::fill, from those of the colour channels.
inline float luminance_variance(float r, float g, float b) {
    const float deviation = luminance(std::sqrt(r), std::sqrt(g), std::sqrt(b));
    return deviation * deviation;
}

}  // namespace tessera::filter::pixel

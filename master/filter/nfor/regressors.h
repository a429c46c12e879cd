#pragma once

#include <array>
#include <span>

#include "master/filter/nfor/joint_nl_means.h"

namespace tessera::filter::nfor {

// Regressors of the light: albedo (3), mapped normal (3) and 1 / depth (1), which is linear in the picture on
// planes and 0 at misses; scaled so that its mean over surfaces is 1, and cut at 10.
inline constexpr std::uint32_t FeatureCount = 7;

// Features of the frame, prefiltered by NL-means. Films have no variance of features; the mean of n samples
// whose pixel may lie across an edge is given the variance of its 3 x 3 neighbourhood over n. Without noise,
// similar pixels do not differ and others differ by far more, so exact features are preserved. Missing
// features are 0.
class Regressors {
  public:
    void gather(const Inputs& inputs, RunContext& context);
    // The planes filled by gather(); the caller fills their holes.
    std::array<Planes, 3>& raw() { return raw_; }
    // False: stopped.
    bool prefilter(const Inputs& inputs, RunContext& context);

    // After prefilter(): feature i in [0, FeatureCount).
    std::span<const float> plane(std::uint32_t i) const { return smooth_[i / 3].plane(i % 3); }

  private:
    JointNlMeans nl_means_;
    std::array<Planes, 3> raw_, variance_, smooth_;  // albedo, normal, depth
};

}  // namespace tessera::filter::nfor

#pragma once

#include "master/filter/svgf/accumulate.h"

namespace tessera::filter::svgf {

// How much of the filtered light F to take, the rest coming from the film U: the weight of
// master/filter/fade.h,
//
//     w = min(1, sum V_U s^2 / sum (F - U)^2 s^2)
//
// where the numerator is at most the spread of F - U between neighbours,
// with s = 1 / (|F| + a tenth of the mean of |F|) over 11x11 pixels, on luminance alone: without the albedo
// there is little colour left. The weight that F gives to the pixel itself counts as 0. Pixels with n < 2
// have no say and get 1.
class FadeLight {
  public:
    // `film` are moments as they came from the film, nothing blended in. False: stopped.
    bool run(const Planes& film, const PaddedPlanes& filtered, RunContext& context);

    const Planes& weights() const { return weights_; }  // 1 component in [0, 1]

  private:
    Planes terms_;  // luminance of F; (F - U) s; then V_U s^2, (F - U)^2 s^2 and the spread of (F - U) s
    Planes weights_;
    std::vector<double> row_sums_;
    std::vector<float> no_samples_;
};

}  // namespace tessera::filter::svgf

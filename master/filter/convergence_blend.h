#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "master/filter/scratch.h"

namespace tessera::filter {

// Prevents a denoiser from increasing the error of a nearly converged picture (Lardinoije L36):
//
//     out = U + w (F - U)          U unfiltered, F filtered, T the truth
//
// E|out - T|^2 is least at w = E[(U - T)(U - F)] / E[(F - U)^2]. U is unbiased, so the numerator is
// V_U - Cov(U, F) = V_U (1 - a): V_U is the variance of the mean, a the weight that F gives to the pixel
// itself (0 where unknown: w is then a little too large and is cut at 1). Hence
//
//     w = min(1, sum V_U (1 - a) s^2 / sum (F - U)^2 s^2)     over a square of (2 radius + 1)^2 pixels
//
// Where F has no bias the denominator is no larger than about V_U and w stays near 1; where it is biased the
// denominator tends to bias^2 while V_U tends to 0, and with them w.
//
// s = 1 / (|F| + a tenth of the mean of |F|) per channel makes errors relative, as relMSE does, so that
// bright pixels do not decide for dark neighbours. s must not depend on U: where light is found rarely the
// pixels that found none would count for more than those that did, and w would be far too small. A firefly
// has V_U = (F - U)^2 up to terms in F, so it is removed as F does.
//
// Pixels with n < 2 have no known variance: they do not contribute to the sums, and w = 1 there.
//
// V_U is that of stratified samples (frame/design_effect.h), which is still too large in places. So
// the numerator is bounded by an estimate from F - U itself: neighbours have independent noise but much the
// same bias, hence half of E(D_p - D_q)^2 of adjacent p, q is the variance of U without the bias. Where bias
// changes its sign from pixel to pixel it counts as noise, and V_U alone decides.
//
// Where well-known pixels are next to noisy ones (a dark reflection next to fireflies), the noisy ones
// dominate the whole square, and light that leaked into the others is kept. So w is at most
//
//     Margin w_3,     w_3 the same ratio over 3 x 3 pixels alone
//
// but 9 pixels may by chance contain none of the rare samples that cause the variance. The square contains N
// = (sum A)^2 / sum A^2 such pixels, A^2 = V_U (1 - a) s^2, and 9 pixels are expected to contain e = N 9 / (2
// radius + 1)^2. With fewer than three the variance is unknown, which happens with the probability m =
// exp(-e) (1 + e + e^2 / 2); hence w <- m w + (1 - m) min(w, Margin w_3).
//
// relMSE blended / unfiltered at 4, 16, 64, 256 samples, 96 x 54, without and with this bound:
//
//     room-1    fdf  .121 .159 .223 .328    .097 .132 .211 .321
//               nfor .231 .194 .242 .414    .157 .158 .238 .411
//             statmc .129 .201 .335 .470    .111 .174 .294 .461
//     studio-1  fdf  .784 .637 .708 .891    .426 .528 .658 .850
//               nfor 10.5 5.72 .764 .614    9.96 5.29 .676 .613
//             statmc 2.28 .805 .839 .872    1.63 .671 .755 .852
//
// A Margin of 1 is .006 better in studio-1 and worse in room-1, 2 is the other way round. With m = exp(-e)
// studio-1 gains more, but light that 2 % of the samples find loses 9 % of its energy at 4 samples.
//
// Measured without it, 192 x 192, relMSE blended / unfiltered, Gauss of sigma 0.7, 2, 6 as
// filters, four scenes (shadows and checkers; the same with fireflies of 50 x brightness; light found by 1 to
// 4 % of the samples; an edge of contrast 100), 4 to 4096 samples per pixel. Without the blend it reaches
// 3600.
//
//     radius                              0      1      2      3      4      5      7      10     15
//     worst of 72                         1.19   0.91   0.92   0.91   0.90   0.91   0.93   0.95   1.07
//     shadows, sigma 2, n = 4             0.539  0.198  0.152  0.136  0.130  0.126  0.123  0.121  0.121
//     shadows, sigma 2, n = 256           0.851  0.562  0.540  0.534  0.532  0.531  0.531  0.538  0.547
//     rare light, sigma 6, n = 16         0.314  0.078  0.035  0.021  0.015  0.011  0.007  0.005  0.004
//     edge, sigma 2, n = 64               0.381  0.142  0.124  0.141  0.169  0.203  0.282  0.432  0.775
//
// Small squares follow edges of the bias, large ones estimate w better; 5 is a compromise.
class ConvergenceBlend {
  public:
    static constexpr std::uint32_t MaxRadius = 15;
    static constexpr float Margin = 1.4f;

    explicit ConvergenceBlend(std::uint32_t radius = 5) : radius_(std::min(radius, MaxRadius)) {}

    // Blends every component of `picture` (Inputs::color_components()), alpha with the same w.
    // `filtered_part`: the channel of Moments that was filtered, Radiance or a part of it; the rest of the
    // radiance is the same in F and U. `self_weight` is a in [0, 1] per pixel, or empty. False: stopped; the
    // picture is undefined.
    bool apply(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> self_weight,
               Planes& picture, RunContext& context);

    // w of the last run, 1 component in [0, 1].
    const Planes& weights() const { return weights_; }

    // Memory traffic of apply().
    static double bytes_per_pixel(std::uint32_t components) { return 128.0 + 12.0 * components; }

  private:
    bool weigh(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> self_weight,
               const Planes& filtered, RunContext& context);

    std::uint32_t radius_;
    Planes terms_;  // per pixel, see the source
    Planes weights_;
    std::vector<double> row_sums_;
    Scratch scratch_;
};

}  // namespace tessera::filter

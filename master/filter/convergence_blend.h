#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "master/filter/lost_light.h"
#include "master/filter/scratch.h"

namespace tessera::filter {

// Prevents a denoiser from increasing the error of a nearly converged picture (Lardinoije L36), in three bands of
// spatial frequency.
//
// U is the unfiltered picture, F the filtered one, T the truth, S = |F| + a tenth of the mean of |F| per channel.
// With n and W for smoothing by [1 2 1] / 4 and by [1 2 3 4 3 2 1] / 16, both in both directions,
//
//     U - F = d_0 + d_1 + d_2        d_0 = S (R - n R)        d_1 = S n R - d_2        d_2 = W (U - F)
//     R = (U - F) / S
//     out = F + sum_j (1 - w_j) d_j
//     w_j = sum N_j / (sum N_j + B_j)        over (2 radius + 1)^2 pixels
//
// N_j is the variance of d_j / S due to noise: that of the mean of U times 1 - a, where a is the weight that F gives to
// the pixel itself (0 where unknown; exactly, 2 a minus the sum of all squared weights, the same if those are equal),
// times what smoothing leaves of independent noise. B_j is the squared bias of F:
// what (d_j / S)^2 exceeds N_j by. With one band this is the shrinkage of James and Stein with pooled variance, whose
// error is least at w = E[(U - T)(U - F)] / E[(U - F)^2]. Noise is mostly in the fine band, the bias of a denoiser in the
// coarse one; so the coarse band corrects the bias and its loss of light with little of the noise of U, and the fine
// one does so only at edges that were blurred. d_0 is smoothed relative to S so that noise does not spread from bright
// pixels to dark ones; d_2 is not, because F contains U, so that the mean of R is below that of U - F.
//
//     B_j = max(0, sum (d_j / S)^2 - sum N_j - sqrt(sum N_j^2 / 2))
//
// The last term is half the standard error of a sum of squares of independent normal numbers, which those of neighbours
// are not quite: noise alone does not count as bias, which would let single samples through as specks. Without it SSIM
// falls below that of F in rooms of indirect light; with twice as much, F blurs fine shadows.
//
// Differences are relative to S, as in relMSE, so that bright pixels do not decide for dark neighbours. Where light is
// found rarely that underestimates the error of spreading it: a dark pixel that F makes bright is measured against that
// brightness. A pixel has seen next to nothing of what causes the variance if its own is below 2 % of the mean in the
// square. If F makes it brighter, it may be wrong, or the pixel was unlucky: dark pixels that happened to find nothing
// look the same. The difference is divided by the darker of U and F instead, weighted by the probability that the light
// of F is not there. That is the greatest of
//
//     e^-q (1 + q + q^2 / 2 + q^3 / 6)    the square has so few finds that they say nothing
//     e^-E (1 + E) (1 - e^-e)             light is rare, and the pixel would have found something
//     0 to 1 from e = 16 to 32            the pixel would have found much (finds differ in strength)
//
// where q = (sum A)^2 / sum A^2, A^2 = N_0, are the finds of the square, E those of 25 pixels of it, and
// e = |F| sum |F| / sum V those of the pixel, if its light is that of F.
//
// The coarse bands take the light of single finds to dark pixels around them: of what exceeds max(U, F), `out` loses the part
// e^-K (1 + K), where K are the finds of 25 pixels by (sum N_0)^2 / sum N_0^2.
//
// Where the samples found nothing their variance is small as well, so that w is smaller there than where they found much:
// the blend takes light away. lost_light.h gives it back, in proportion to S times the root of the mean noise around each
// pixel (N_0), but at most to S: a single find does not draw all of it.
//
// Pixels with n < 2 have no known variance: they keep F and do not contribute. Alpha has the bands and w of the light.
// Light below 0 and alpha outside [0, 1] become 0 or 1, which are nearer to any truth.
//
// relMSE of blended / unfiltered without the worst 0.1 % of the pixels, geometric mean (most) over cornell, grids,
// caustics, studio-1 and room-1, 128 x 72, at 4, 16, 64 and 256 samples:
//
//                                fdf           nfor          pixel         psvgf         statmc
//     one band, pooled           0.48 (5.3)    0.72 (41)     0.77 (17)     0.58 (1.4)    0.75 (45)
//     three, B_j without root    0.39 (1.3)    0.59 (10)     0.64 (13)     0.50 (1.5)    0.47 (3.5)
//     three                      0.41 (1.3)    0.65 (16)     0.69 (16)     0.51 (1.6)    0.50 (5.2)
//     and rare light             0.40 (1.3)    0.44 (1.2)    0.48 (1.0)    0.50 (1.6)    0.38 (1.0)
//     and d_0 relative           0.38 (1.4)    0.44 (1.2)    0.48 (1.0)    0.47 (1.6)    0.36 (1.0)
//     and a of psvgf                                                       0.44 (1.05)
//
// Over all eight bench scenes, 96 x 54, two seeds, 4 to 64 samples. Before, the coarse bands had no limit, lost light had no
// limit in proportion to S, and "so few" was two finds:
//
//     before, all pixels         0.35 (1.03)   0.28 (1.13)   0.38 (2.1)    0.50 (1.12)   0.29 (0.99)
//     as it is, all pixels       0.35 (1.03)   0.27 (1.13)   0.36 (1.0)    0.51 (1.12)   0.29 (0.99)
//     before, trimmed            0.35 (0.94)   0.36 (1.6)    0.42 (2.5)    0.50 (1.04)   0.34 (0.94)
//     as it is, trimmed          0.34 (0.94)   0.34 (1.3)    0.39 (1.9)    0.50 (1.04)   0.33 (0.91)
class ConvergenceBlend {
  public:
    static constexpr std::uint32_t MaxRadius = 15;
    static constexpr std::size_t Bands = 3;

    explicit ConvergenceBlend(std::uint32_t radius = 5) : radius_(std::min(radius, MaxRadius)) {}

    // Blends every component of `picture` (Inputs::color_components()), alpha with the same w.
    // `filtered_part`: the channel of Moments that was filtered, Radiance or a part of it; the rest of the
    // radiance is the same in F and U. `self_weight` is a in [0, 1] per pixel, or empty. False: stopped; the
    // picture is undefined.
    bool apply(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> self_weight,
               Planes& picture, RunContext& context);

    // w of the last run in [0, 1], a component per band, the finest first.
    const Planes& weights() const { return weights_; }

    // Memory traffic of apply().
    static double bytes_per_pixel(std::uint32_t components) { return 368.0 + 64.0 * components; }

  private:
    bool weigh(const Inputs& inputs, frame::Channel filtered_part, std::span<const float> self_weight,
               const Planes& filtered, float floor, RunContext& context);
    void fill_bands(const Planes& filtered, float floor, std::uint32_t block);

    std::uint32_t radius_;
    Planes residual_, wide_;    // U - F and its coarse band
    Planes relative_, narrow_;  // U - F divided by F and smoothed
    Planes terms_, weights_;
    std::vector<double> row_sums_;
    LostLight lost_light_;
    Scratch scratch_;
};

}  // namespace tessera::filter

#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "master/filter/nfor/regressors.h"
#include "master/filter/pack.h"

namespace tessera::filter::nfor {

// The variables of the first-order model: x, y in the picture and the features. Five colours are regressed: r, g, b,
// alpha and one more, which have the fit's weights.
inline constexpr std::size_t Variables = 2 + FeatureCount, Colors = 5;

// One pixel of a window, seen from eight neighbouring centres.
struct Tap {
    float dx, dy;           // from centre to pixel
    std::ptrdiff_t offset;  // from the centre to the pixel in a plane
};

// The planes read for eight centres; plane i starts at `base + i * plane`.
struct Window {
    std::span<const Tap> taps;
    const float* features;  // FeatureCount planes, at the centres
    const float* colors;    // Colors planes
    const float* noise;     // variance of the colours, summed over r, g, b; see `correlated`
    std::size_t plane;
    // Neighbours share noise: `noise` is three planes of half differences of r, g, b (see Guide), whose variance in the
    // window is the part of the colours' variance due to noise.
    bool correlated = false;
};

// A weighted first-order fit of colours around each of eight pixels p,
//
//     c(q) ~ c_0 + sum_i b_i (v_i(q) - m_i)        m the weighted means of the variables
//
// by normal equations of differences to p, whose rounding is relative to the window's own spread. With C the
// weighted covariance of the variables the ridge is
//
//     (C + diag(r (C_ii + f) + r_0 M_ii)) b = cov(v, c)      r = r_0 + S / (N (max(0, T - S) + sqrt(2 / N) T))
//
// N = (sum w)^2 / sum w^2 the effective number of pixels, T the weighted variance of the colours, S the part
// explained by noise. This is Hoerl and Kennard's ridge (1970), noise over N times the largest squared
// coefficient of standardised variables, which is at most the signal T - S. The signal gets its standard error,
// sqrt(2 / N) T for normal numbers, on top: S is an estimate, and often above T where the light is found rarely.
// Without it such windows were their mean and lost all texture: relMSE without the blend was 1.2 times as high
// (geometric mean over cornell, grids, caustics, studio-1 and room-1, 4 to 256 samples).
//
// C_ii is the difference of the second moment M_ii around p and a square, so its rounding is relative to M_ii: r_0 = 1e-5 is ten times the rounding of sums of
// some hundred floats, and the matrix stays positive definite. f = 1e-6: features that vary by less than
// 0.001 carry little information in noise. With features all equal, C and b are 0.
class Fit {
  public:
    // weights: eight per tap. Centres without weight get known() = 0 and otherwise finite numbers.
    void solve(const Window& window, const float* weights);

    // Weighted number of pixels > 0: 1, else 0.
    Pack known() const { return known_; }

    // The model at a tap: colours relative to those of p.
    std::array<Pack, Colors> at(const Window& window, const Tap& tap) const;

  private:
    Pack known_;
    std::array<Pack, Colors> intercept_;
    std::array<std::array<Pack, Colors>, Variables> slope_;
};

}  // namespace tessera::filter::nfor

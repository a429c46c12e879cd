#pragma once

#include "master/filter/fdf/nl_means.h"

namespace tessera::filter {

enum class Demodulation : std::uint8_t { Off, On };

struct FeatureSettings {
    std::uint32_t radius = 8;
    // Distances at which the weight has fallen to 1/e. Normals are mapped to (x + 1) / 2. The shading's is
    // for one sample: at n samples it is s_max / n.
    float t_max = 0.03f, n_max = 0.06f, s_max = 5.0f;
    Demodulation demodulation = Demodulation::Off;
};

inline constexpr std::uint32_t FeatureMaxRadius = 16;

// A change of all pixels at once, and what it does to the picture: the change of colour is the standard deviation of
// each component times the sign, that of the shading is given, and both are scaled by a small step. The response is
// measured in half of one of ProbeSpacing rows and divided by the step.
struct Probe {
    const Planes &signs, &shading;  // 1 component; +1 or -1; a change at full scale
    Planes &change, &response;      // 1 component: summed over r, g, b, and 0 where not measured
};
inline constexpr std::uint32_t ProbeSpacing = 4;

// Albedo components below it are not divided out: light from such surfaces is not diffusely reflected.
inline constexpr float DemodulationFloor = 0.01f;

// The weighted mean of the samples of a window with similar features (Lardinoije E-L8, E-L9), no spatial
// weight:
//
//     out(p) = sum n_q w(p,q) c(q) / sum n_q w(p,q)
//     w(p,q) = exp(-max(d_t, d_n, d_s))        0 between pixels of different classes
//     d_t, d_n = max over components |f(p) - f(q)| / f_max
//     d_s = |s(p) - s(q)| min(n_p, n_q) / s_max
//
// n_q makes it the mean over samples, as if those of all similar pixels were pooled; with equal counts it is
// the thesis' mean over pixels. min(n_p, n_q) is symmetric, and the noise of the pixel with fewer samples
// does not look like an edge; its contribution to a better known pixel is small, due to n_q. Holes have no
// weight and become 0.
//
// Distances are kept in units of log2 in a copy of the tile and its margin; eight pixels stay in registers
// over all (2 radius + 1)^2 taps, at about 37 operations per tap.
class FeatureBilateral {
  public:
    // `shading` (in units of its own mean, 1 component) and `classes` as for NlMeans; Albedo and Normal are
    // ignored if the inputs lack them. `out` has Inputs::color_components(); `self_weight` gets the weight of
    // the pixel in its own result, 1 component. `probe` may be null. False: stopped.
    bool run(const Inputs& inputs, const Planes& shading, const Planes& classes,
             const FeatureSettings& settings, Planes& out, Planes& self_weight, RunContext& context,
             const Probe* probe = nullptr);

  private:
    Scratch scratch_;
};

}  // namespace tessera::filter

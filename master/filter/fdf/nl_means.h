#pragma once

#include "master/filter/scratch.h"

namespace tessera::filter {

// Pixels of different classes are never averaged.
enum class PixelClass : std::uint8_t { Hole, Surface, Background };

enum class NlmForm : std::uint8_t { Thesis, Standard };

struct NlmSettings {
    NlmForm form = NlmForm::Standard;
    std::uint32_t radius = 5, patch = 2;
    float k = 0.5f;  // standard form only: how many standard deviations still count as equal
};

inline constexpr std::uint32_t NlmMaxRadius = 10, NlmMaxPatch = 4;

// Added to the variances where they divide (E-L7), for values of order 1.
inline constexpr float NlmEpsilon = 1e-10f;

// NL-means of one plane with known variances (Lardinoije E-L4 ... E-L7), over a window of (2 radius + 1)^2:
//
//     f(p) = sum w(p,q) v(q) / sum w(p,q)
//     Thesis    w = mean of exp(-(v_a - v_b)^2 / (eps + V_a + V_b)) over the pairs a = p + o, b = q + o
//     Standard  w = exp(-max(0, mean of ((v_a - v_b)^2 - V_a - min(V_a, V_b)) / (eps + k^2 (V_a + V_b))))
//
// with o over a patch of (2 patch + 1)^2. Only pixels q of the class of p have weight. A pair a, b of
// different classes, or out of the picture, carries no information: it counts as the expectation for equal
// pixels, which is 1 / sqrt(3) (Thesis) and 0 (Standard).
//
// For each offset the pairs are computed once and summed by box sums: 121 offsets at about 50 operations
// instead of 121 * 25 pairs.
class NlMeans {
  public:
    // values in [0, 1e9], variances in [0, 1e18], classes as numbers of PixelClass; one component each.
    // With `change`, small changes of the values, `out_change` gets those of `out`, as if weights did not change.
    // False: stopped.
    bool run(const Planes& values, const Planes& variances, const Planes& classes,
             const NlmSettings& settings, Planes& out, RunContext& context, const Planes* change = nullptr,
             Planes* out_change = nullptr);

  private:
    Scratch scratch_;
};

}  // namespace tessera::filter

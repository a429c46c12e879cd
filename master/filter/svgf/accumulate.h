#pragma once

#include "master/filter/kernels.h"
#include "master/filter/svgf/padded_planes.h"

namespace tessera::filter::svgf {

// The accumulated state of one signal, per pixel.
struct State {
    PaddedPlanes color;  // SignalComponents; the variance is that of the wavelet transform
    Planes moments;      // mean luminance, E[L^2] - E[L]^2 of one sample (E-D6), age in samples
};
inline constexpr std::uint32_t MeanLuminance = 0, SampleVariance = 1, Age = 2, MomentCount = 3;

// A reprojected state as planes, in this order.
inline constexpr std::uint32_t HistoryMoments = 3, HistoryCount = HistoryMoments + MomentCount;

struct Accumulation {
    float r0 = 0.1f;         // minimum weight of a new sample (E-D3)
    float age_scale = 1.0f;  // factor of the history's age after a change of light
    float z0 = 0.0f;         // deviations that light may differ before history is distrusted; 0: not tested
};

// The weight of n new samples against a history of `age` samples: E-D3 applied sample by sample, r0 -> 1 - (1
// - r0)^n. `keep` is ln(1 - r0).
inline float new_weight(float n, float age, float keep) {
    const float least = 1.0f - exp_negative(keep * n);
    const float mean = n / std::max(n + age, 1e-6f);
    return std::max(least, mean);
}

// Of the film and of its history, 3 components each, where every pixel has the same expected value in both.
struct Albedos {
    const Planes *film = nullptr, *history = nullptr;
};

// Blends the film in `state` with the history, moments with the same weights (E-D2, E-D5; the variance by an
// equivalent rule without cancellation). Pixels without samples keep their history. With albedos,
// colours are weighted by them as well, so that their product with the mean albedo is the mean light of pixels that see
// several surfaces. False: stopped.
bool accumulate(const Planes& history, const Accumulation& how, const Albedos& albedos, State& state,
                Planes& trust, RunContext& context);

}  // namespace tessera::filter::svgf

#pragma once

#include "master/filter/svgf/accumulate.h"

namespace tessera::filter::svgf {

// Splits the film into signals: light of the diffuse lobe divided by the albedo, and the rest of the
// radiance.

// Below it the light carries no information on the irradiance, and is not visible.
inline constexpr float LeastAlbedo = 1e-4f;

// HighVariance holds the light of the diffuse lobe, and LowVariance the rest.
bool knows_diffuse(const Inputs& inputs);

// Diffuse light divided by the albedo: HighVariance / Albedo, so that albedo x irradiance is the film's own
// diffuse mean exactly, including its noise, also in partly covered pixels; the mean Irradiance where there
// is no albedo or HighVariance holds other paths. Its variance is that of Irradiance, scaled.
bool demodulate(const Inputs& inputs, State& state, RunContext& context);

// The radiance without the diffuse light: LowVariance, or where HighVariance holds other paths Radiance -
// Albedo x Irradiance, written to `own`. `rest` points to either.
bool find_rest(const Inputs& inputs, Planes& own, const Planes*& rest, RunContext& context);

// The rest as a separate signal, not demodulated.
bool take_rest(const Inputs& inputs, const Planes& rest, State& state, RunContext& context);

}  // namespace tessera::filter::svgf

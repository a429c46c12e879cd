#pragma once

#include "master/filter/svgf/accumulate.h"

namespace tessera::filter::svgf {

// The film as the signals see it. Light of the diffuse lobe has the albedo divided out; the rest is what is
// left of the radiance.

// HighVariance holds the light of the diffuse lobe, and LowVariance the rest.
bool knows_diffuse(const Inputs& inputs);

// Diffuse light through the albedo: HighVariance / Albedo, so that albedo x irradiance is the film's own
// diffuse mean to the last bit of noise, also where a pixel shows the surface in part; the mean Irradiance
// where there is no albedo or HighVariance holds other paths. Its variance is that of Irradiance, scaled.
bool demodulate(const Inputs& inputs, State& state, RunContext& context);

// What the diffuse light leaves of the radiance: LowVariance, or where HighVariance holds other paths
// Radiance - Albedo x Irradiance, written to `own`. `rest` points to either.
bool find_rest(const Inputs& inputs, Planes& own, const Planes*& rest, RunContext& context);

// The rest as a signal of its own, nothing divided out.
bool take_rest(const Inputs& inputs, const Planes& rest, State& state, RunContext& context);

}  // namespace tessera::filter::svgf

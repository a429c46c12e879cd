#ifndef TESSERA_MEDIATOR_SHADING_PHASE_H
#define TESSERA_MEDIATOR_SHADING_PHASE_H

#include "mediator/shading/maths.h"

// Scattering in a medium by Henyey and Greenstein (1941), isotropic for g = 0. The frame's z axis points back
// along the path; densities are per solid angle, and the value equals the density. Computed from the versine
// 1 - cos of the angle to the peak direction, which does not cancel there.
SHADING_BEGIN

// |g| closer to 1 would scatter by less than a pixel's width, with an unbounded density.
inline constexpr float MaxAnisotropy = 0.9999f;

inline float phase_value(float g, vec3 wi) {
    const float along = g < 0.0f ? wi.z : -wi.z;
    const float versine = along > 0.0f ? (wi.x * wi.x + wi.y * wi.y) / (1.0f + along) : 1.0f - along;
    const float a = abs(g);
    const float distance2 = (1.0f - a) * (1.0f - a) + 2.0f * a * versine;
    return 0.25f * InversePi * (1.0f - a) * (1.0f + a) / (distance2 * sqrt(distance2));
}

// By inversion of the integral over the cosine.
inline vec3 sample_phase(float g, vec2 u) {
    const float a = abs(g);
    const float width = 1.0f - a + 2.0f * a * u.x;
    const float ratio = (1.0f - a) * (1.0f + a) / width;
    const float versine = lesser_of((1.0f - a) * (1.0f - u.x) * (ratio + (1.0f - a)) / width, 2.0f);
    const float across = sqrt(versine * (2.0f - versine));
    const float along = 1.0f - versine;
    const float angle = 2.0f * Pi * u.y;
    return vec3(across * cosine(angle), across * sine(angle), g < 0.0f ? along : -along);
}

SHADING_END

#endif

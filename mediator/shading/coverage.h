#ifndef TESSERA_MEDIATOR_SHADING_COVERAGE_H
#define TESSERA_MEDIATOR_SHADING_COVERAGE_H

#include "mediator/shading/paths.h"

// Which objects are seen (Schwenk 5.4.3).
SHADING_BEGIN

// Of each object its own: chosen by its id, and never black, which is where nothing is.
inline vec3 object_color(uint object) {
    const uint bits = hash_u32(object);
    return (vec3(float(bits & 255u), float((bits >> 8u) & 255u), float((bits >> 16u) & 255u)) + 51.0f) *
           (1.0f / 306.0f);
}

inline void show_object(INOUT(PathSample) found, uint object, float depth) {
    found.low = object_color(object);
    found.depth = depth;
    found.object = object;
    found.alpha = 1.0f;
}

SHADING_END

#endif

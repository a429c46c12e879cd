#ifndef TESSERA_MEDIATOR_SHADING_OBJECT_ID_H
#define TESSERA_MEDIATOR_SHADING_OBJECT_ID_H

#include "mediator/shading/paths.h"

// The object-ID renderer (documented as "coverage"): which objects are visible (Schwenk 5.4.3).
SHADING_BEGIN

// A colour by object id; never black, which means a miss.
inline vec3 object_color(uint object) {
    const uint bits = hash_u32(object);
    return (vec3(float(bits & 255u), float((bits >> 8u) & 255u), float((bits >> 16u) & 255u)) + 51.0f) *
           (1.0f / 306.0f);
}

inline void record_object_id(INOUT(PathSample) found, uint object, float depth) {
    found.low = object_color(object);
    found.depth = depth;
    found.object = object;
    found.alpha = 1.0f;
}

SHADING_END

#endif

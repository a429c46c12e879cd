#ifndef TESSERA_MEDIATOR_SHADING_RAYS_H
#define TESSERA_MEDIATOR_SHADING_RAYS_H

#include "mediator/shading/records.h"

RECORDS_BEGIN

struct Ray {
    vec3 origin;
    vec3 direction;  // unit length
};

inline constexpr uint NoInstance = 0xffffffffu;  // of a Hit: a miss

// Hits to skip because the ray has passed them already: all up to `near`, and those of one instance up to
// `far`; and all on unlit surfaces (passes_unlit).
struct Skip {
    uint instance;
    float near;
    float far;
    bool unlit;
};

struct Hit {
    uint instance;     // index
    uint triangle;     // of its mesh
    vec2 barycentric;  // weights of the second and third vertex
    float distance;
};

inline bool skips(IN(Skip) skip, uint instance, float distance) {
    return instance == skip.instance && distance <= skip.far;
}

// A path starts exactly on its surface where the error bound is 0 (an axis-aligned plane through the origin):
// nearer hits are on that surface. The smallest number that no device flushes to 0.
inline constexpr float NearestHit = 1.17549435e-38f;

inline Skip skip_nothing() {
    return Skip(NoInstance, NearestHit, 0.0f, false);
}

RECORDS_END

#endif

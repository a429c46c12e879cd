#ifndef TESSERA_MEDIATOR_SHADING_ASKED_RAY_H
#define TESSERA_MEDIATOR_SHADING_ASKED_RAY_H

#include "mediator/shading/rays.h"

SHADING_BEGIN

// A ray of bare traversal: hits count with near < distance <= far, in lengths of the direction.
struct AskedRay {
    vec3 origin;
    float near;
    vec3 direction;
    float far;
};

#ifdef __cplusplus
static_assert(sizeof(AskedRay) == 32 && offsetof(AskedRay, near) == 12);
static_assert(offsetof(AskedRay, direction) == 16 && offsetof(AskedRay, far) == 28);
static_assert(sizeof(Hit) == 20 && offsetof(Hit, barycentric) == 8 && offsetof(Hit, distance) == 16);
#endif

SHADING_END

#endif

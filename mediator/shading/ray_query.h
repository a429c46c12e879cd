#ifndef TESSERA_MEDIATOR_SHADING_RAY_QUERY_H
#define TESSERA_MEDIATOR_SHADING_RAY_QUERY_H

#include "mediator/shading/rays.h"

SHADING_BEGIN

// A ray for plain BVH traversal: hits with near < distance <= far, in multiples of the direction's length.
struct RayQuery {
    vec3 origin;
    float near;
    vec3 direction;
    float far;
};

#ifdef __cplusplus
static_assert(sizeof(RayQuery) == 32 && offsetof(RayQuery, near) == 12);
static_assert(offsetof(RayQuery, direction) == 16 && offsetof(RayQuery, far) == 28);
static_assert(sizeof(Hit) == 20 && offsetof(Hit, barycentric) == 8 && offsetof(Hit, distance) == 16);
#endif

SHADING_END

#endif

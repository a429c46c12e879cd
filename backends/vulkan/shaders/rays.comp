#version 460
#extension GL_GOOGLE_include_directive : require
// Traversal without shading: one ray per invocation. With TEXELS, pool and rays are texel buffers and hits are a
// storage buffer; otherwise all are accessed by address. With BVH2 the pool has binary BVHs, the baseline.

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint Question = 0u;
layout(constant_id = 1) const uint PassesEvery = 0u;

#ifdef TEXELS
layout(set = 0, binding = 0) uniform usamplerBuffer pool_texels;
layout(set = 0, binding = 1) uniform usamplerBuffer ray_texels;
#define BVH_TEXELS pool_texels
#endif

struct Context {
    uint unused;
};

#ifdef BVH2
#include "mediator/shading/bvh2_trace.h"
#else
#include "mediator/shading/bvh_trace.h"
#endif

#include "mediator/shading/ray_query.h"

ARRAY_OF(RayQuery, AskedRays, 16);
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Hits {
    Hit items[];
};

layout(push_constant, scalar) uniform Arguments {
    BvhItems pool;
    AskedRays rays;
    Hits hits;
    uint top;
    uint count;
};

// Instead of a texture's alpha.
bool stops_ray(IN(Context) context, IN(Hit) candidate, IN(Sampler) numbers) {
    return PassesEvery == 0u || candidate.triangle % PassesEvery != 0u;
}

#ifdef TEXELS
layout(set = 0, binding = 2, scalar) writeonly buffer BoundHits {
    Hit bound_hits[];
};

RayQuery asked_ray(uint at) {
    const vec4 start = uintBitsToFloat(texelFetch(ray_texels, int(2u * at)));
    const vec4 direction = uintBitsToFloat(texelFetch(ray_texels, int(2u * at + 1u)));
    return RayQuery(start.xyz, start.w, direction.xyz, direction.w);
}
#endif

void main() {
    const uint at = gl_GlobalInvocationID.x;
    if (at >= count) return;
    Context context;
    context.unused = 0u;
#if defined(BVH2)
    const RayQuery ray = rays.items[at];
    hits.items[at] =
        bvh2_trace(pool, top, ray.origin, ray.direction, ray.near, ray.far, Question, AllLayers, 0.0f, context, Sampler(0u, 0u));
#elif defined(TEXELS)
    const RayQuery ray = asked_ray(at);
    bound_hits[at] =
        bvh_trace(pool, top, ray.origin, ray.direction, ray.near, ray.far, Question, AllLayers, 0.0f, context, Sampler(0u, 0u));
#else
    const RayQuery ray = rays.items[at];
    hits.items[at] =
        bvh_trace(pool, top, ray.origin, ray.direction, ray.near, ray.far, Question, AllLayers, 0.0f, context, Sampler(0u, 0u));
#endif
}

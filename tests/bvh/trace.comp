#version 460
#extension GL_GOOGLE_include_directive : require
// Many rays, one each invocation. With TEXELS the pool is read through a texel buffer.

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint Question = 0u;

#ifdef TEXELS
layout(set = 0, binding = 0) uniform usamplerBuffer pool_texels;
#define BVH_TEXELS pool_texels
#endif

struct Context {
    uint unused;
};

#include "mediator/shading/bvh_trace.h"

struct AskedRay {
    vec3 origin;
    float near;
    vec3 direction;
    float far;
};

ARRAY_OF(AskedRay, AskedRays, 16);
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

// As ThirdsPass in traced_scene.h.
bool stops_ray(IN(Context) context, IN(Hit) candidate, uint seed) {
    return candidate.triangle % 3u != 0u;
}

void main() {
    const uint at = gl_GlobalInvocationID.x;
    if (at >= count) return;
    const AskedRay ray = rays.items[at];
    Context context;
    context.unused = 0u;
    hits.items[at] = bvh_trace(pool, top, ray.origin, ray.direction, ray.near, ray.far, Question, context, 0u);
}

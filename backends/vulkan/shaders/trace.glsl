// The path tracer's kernel: one invocation is one sample of one pixel. The including file may define
// BVH_TEXELS, if it has the pool of the acceleration structure bound as texels.
layout(local_size_x_id = 0) in;

// What the scene and the view need; the rest is left out when the pipeline is made.
layout(constant_id = 1) const uint Features = 0xffffffffu;
layout(constant_id = 2) const uint Channels = 0xffffffffu;
layout(constant_id = 3) const uint Keeps = 0xffffffffu;
layout(constant_id = 4) const uint Renderer = 0u;
layout(constant_id = 5) const uint PixelFilter = 0u;

#include "mediator/shading/bvh_trace.h"
#include "mediator/shading/materials.h"
#include "mediator/shading/rays.h"
#include "mediator/shading/records.h"

struct Context {
    Scene scene;
    View view;
    BvhItems pool;
    uint top;
};

ARRAY_OF(Scene, SceneArray, 8);
ARRAY_OF(View, ViewArray, 8);
layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Values {
    float items[];
};

// As struct Job in job.h.
layout(push_constant, scalar) uniform Arguments {
    SceneArray scene;
    ViewArray view;
    BvhItems pool;
    Values values;
    uint64_t first_sample;
    uint top;
    uint x, y, width;
    uint pixels;
    uint first_item;
    uint item_count;
}
job;

bool trace_closest(const in Context context, const in Ray ray, uint seed, out Hit hit) {
    const BvhAlphaContext alpha = BvhAlphaContext(context.scene, seed);
    const BvhHit found = bvh_trace(context.pool, context.top, ray.origin, ray.direction, NearestHit,
                                   infinity(), closest_question(context.scene), alpha);
    hit = Hit(found.instance, found.triangle, vec2(found.u, found.v), found.distance);
    return found.instance != NoInstance;
}

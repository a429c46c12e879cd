#version 460
// The path tracer: one invocation is one sample of one pixel. (Several samples per
// invocation, each started when the previous one ends, gained nothing on lavapipe: 0.25 against 0.25 Msamples/s.) With
// POOL_AS_TEXELS the acceleration structure is bound as texels instead of being reached by its address; with
// BVH2 it is the binary BVH, the baseline. SPECULAR_TREES includes code that follows all branches of perfect
// specular reflection and refraction, which most views do not need. It is a variant instead of a specialisation
// constant: lavapipe compiles a scene with glass in 2 s instead of 5.7. RASTERISED starts from rasterised first hits.
#extension GL_GOOGLE_include_directive : require
#include "mediator/shading/materials.h"
#include "mediator/shading/rays.h"
#include "mediator/shading/thin_walls.h"

#ifdef POOL_AS_TEXELS
layout(set = 0, binding = 0) uniform usamplerBuffer pool_texels;
#define BVH_TEXELS pool_texels
#endif

layout(local_size_x_id = 0) in;

// Features of the scene: other code is removed when the pipeline is compiled.
layout(constant_id = 1) const uint Features = 0xffffffffu;

struct Context {
    Scene scene;
    View view;
    float time;
    uint64_t pool;  // address; used where the pool is not bound
    uint top;
    Skip skip;      // of the current ray
    bool connects;  // it leads to a light
};

#ifdef BVH2
#include "mediator/shading/bvh2_trace.h"
#define find_hit bvh2_trace
#else
#include "mediator/shading/bvh_trace.h"
#define find_hit bvh_trace
#endif

// Whether the current ray to a light has met thin walls, which do not stop it.
bool wall_is_met = false;

bool stops_ray(IN(Context) context, IN(Hit) candidate, IN(Sampler) numbers) {
    if ((Features & FeatureThinGlass) != 0u && context.connects && is_thin_wall(context.scene, candidate.instance)) {
        wall_is_met = true;
        return false;
    }
    if ((Features & FeatureIndexMatchedMedia) != 0u && skips(context.skip, candidate.instance, candidate.distance)) return false;
    return stops_at(context.scene, context.skip, candidate.instance, candidate.triangle, candidate.barycentric, numbers);
}

uint scene_question() {
    return ((Features & (FeatureAlpha | FeatureIndexMatchedMedia | FeatureThinGlass)) != 0u ? BvhAlpha : 0u) | ((Features & FeatureMotion) != 0u ? BvhMotion : 0u);
}

uint seen_layers(IN(Context) context) {
    return (Features & FeatureLayers) != 0u ? context.view.layers : AllLayers;
}

bool trace_closest(IN(Context) context, IN(Ray) ray, IN(Sampler) numbers, IN(Skip) skip, OUT(Hit) hit) {
    Context asked = context;
    asked.skip = skip;
    hit = find_hit(BvhItems(context.pool), context.top, ray.origin, ray.direction, skip.near, infinity(),
                    BvhClosest | scene_question(), seen_layers(context), context.time, asked, numbers);
    return hit.instance != NoInstance;
}

bool trace_occluded(IN(Context) context, vec3 origin, vec3 segment, float far, IN(Sampler) numbers, OUT(ThinWalls) walls) {
    Context asked = context;
    asked.connects = true;
    asked.skip.unlit = true;
    wall_is_met = false;
    const bool is_hit = find_hit(BvhItems(context.pool), context.top, origin, segment, NearestHit, far,
                                 BvhAny | scene_question(), seen_layers(context), context.time, asked, numbers)
                            .instance != NoInstance;
    walls = no_thin_walls();
    if (wall_is_met) walls = unknown_thin_walls();
    return is_hit;
}

bool has_specular_trees(IN(Context) context) {
#ifdef SPECULAR_TREES
    return true;
#else
    return false;
#endif
}

// No path log.
#define log_camera(context, ray)
#define log_hit(context, surface, throughput)
#define log_miss(context)
#define log_emission(context, emission, direction)
#define log_light(context, direction, gathered)
#define log_specular(context, reflects, direction)
#define log_receiver(context, receiver, ray)

#include "mediator/shading/trace.h"
#ifdef RASTERISED
#include "mediator/shading/raster.h"
#endif

layout(buffer_reference, scalar, buffer_reference_align = 4) writeonly buffer Values {
    float items[];
};

// Written directly to memory: drivers compile arrays with dynamic indices to long chains of branches.
struct Sink {
    Values values;
    uint next, stride;
};
void store_value(INOUT(Sink) sink, float value) {
    sink.values.items[sink.next] = value;
    sink.next += sink.stride;
}

#include "mediator/shading/sample_values.h"

ARRAY_OF(uvec2, UVec2Array, 8);
ARRAY_OF(Scene, SceneArray, 8);
ARRAY_OF(View, ViewArray, 8);
// As struct Job in job.h.
layout(push_constant, scalar) uniform Arguments {
    SceneArray scene;
    ViewArray view;
    uint64_t pool;
    Values values;
    uint64_t first_sample;
    uint top;
    uint x, y, width;
    uint pixels;
    uint first_item, item_count;
    uint tile_pixels;
    UVec2Array seen;
    uint64_t indices;
}
job;

// `at`: of the pixel and sample among those of the tile that are drawn.
Path trace(IN(Context) context, uint x, uint y, uint64_t index, uint at) {
#ifdef RASTERISED
    const Ray ray = camera_ray(context.view, x, y, raster_place(context.view, index));
    const uvec2 ids = job.seen.items[at];
    FirstHit first;
    first.is_known = true;
    first.hit.instance = NoInstance;
    if (ids.x != NoInstance) first.hit = raster_hit(context.scene, ray, ids.x, ids.y);
    return trace_from(context, start_path(make_sampler(x, y, context.view.seed, index)), ray, first);
#else
    return trace_sample(context, x, y, index);
#endif
}

void main() {
    const uint item = gl_GlobalInvocationID.x;
    if (item >= job.item_count) return;
    const uint at = job.first_item + item;
    uint pixel = at % job.pixels;
    if (job.indices != 0ul) pixel = UintArray(job.indices).items[pixel];
    const uint later = at / job.pixels;
    const uint64_t index = job.first_sample + uint64_t(later);

    Context context;
    context.scene = job.scene.items[0];
    context.scene.features = Features;
    context.view = job.view.items[0];
    context.view.strategy = StrategyBoth;
    context.pool = job.pool;
    context.top = job.top;
    context.skip = skip_nothing();
    context.connects = false;

    const uint x = job.x + pixel % job.width, y = job.y + pixel / job.width;
    context.time = sample_time(Features, context.view, x, y, index);

    const Path path = trace(context, x, y, index, later * job.tile_pixels + pixel);
    Sink sink = Sink(job.values, item, job.item_count);
    put_sample_values(sink, context.view, path.found);
    store_value(sink, float_from_bits(path.rays));
}

#ifndef TESSERA_TESTS_SHADING_TEST_SCENE_H
#define TESSERA_TESTS_SHADING_TEST_SCENE_H

#include "mediator/shading/records.h"

SHADING_BEGIN

ARRAY_OF(Scene, SceneArray, 8);
ARRAY_OF(View, ViewArray, 8);

// Scenes and views that functions are tested with (make_test_scene in test_scene_builder.h).
inline constexpr uint SceneCount = 2u, ViewCount = 16u, LightCount = 8u, TreeLightCount = 6u,
                      TriangleEmitters = 20u, LightNodes = 36u, TextureCount = 8u, SurfaceShaderCount = 4u,
                      MediumCount = 4u;
struct TestScene {
    SceneArray scenes;  // the second has no lights and no map
    ViewArray views;
};

// The context of this test: hits are determined by the rays' numbers.
struct Context {
    Scene scene;
    View view;
    float time;
};

SHADING_END

#include "mediator/shading/rays.h"
#include "mediator/shading/sampler.h"
#include "mediator/shading/thin_walls.h"

SHADING_BEGIN

// Invalid rays hit nothing.
inline bool is_ray(vec3 origin, vec3 direction) {
    return is_finite(dot(origin, origin)) && dot(direction, direction) > 0.0f &&
           is_finite(dot(direction, direction));
}

inline Hit hit_by(IN(Scene) scene, uint bits) {
    const uint instance = bits % scene.instance_count;
    const uint triangles = scene.meshes.items[scene.instances.items[instance].mesh].triangle_count;
    const vec2 weights = 0.5f * vec2(unit_float(hash_u32(bits)), unit_float(hash_u32(bits + 1u)));
    return Hit(instance, (bits >> 8) % triangles, weights, 1.0f + unit_float(bits));
}

inline bool trace_closest(IN(Context) context, IN(Ray) ray, IN(Sampler) numbers, IN(Skip) skip,
                          OUT(Hit) hit) {
    const uint bits = hash_u32(numbers.index ^ numbers.seed);
    hit = hit_by(context.scene, bits);
    return is_ray(ray.origin, ray.direction) && (bits & 7u) != 0u && !skips(skip, hit.instance, hit.distance);
}

inline bool trace_occluded(IN(Context) context, vec3 origin, vec3 segment, float far, IN(Sampler) numbers,
                           OUT(ThinWalls) walls) {
    walls = no_thin_walls();
    if ((hash_u32(numbers.index ^ numbers.seed) & 4u) == 0u) walls = unknown_thin_walls();
    if (!is_ray(origin, segment) || !(far > 0.0f) || context.scene.instance_count == 0u) return false;
    return (hash_u32(numbers.index ^ numbers.seed) & 3u) == 0u;
}

inline bool has_specular_trees(IN(Context) context) {
    return context.scene.instance_count > 0u;
}

// A checksum of a sample's values that depends on their order: drivers compile arrays with dynamic indices
// slowly.
struct Sink {
    vec2 sums;  // of the values, and of value x index
    uint infinite;
    uint count;
};
inline void store_value(INOUT(Sink) sink, float value) {
    sink.count += 1u;
    if (is_finite(value)) {
        sink.sums += value * vec2(1.0f, float(sink.count));
    } else {
        sink.infinite += sink.count;
    }
}

SHADING_END

#ifdef __cplusplus
#include "tests/shading/no_path_log.h"
#endif

// These need the declarations above.
#include "mediator/shading/raster.h"
#include "mediator/shading/sample_values.h"
#include "mediator/shading/trace.h"

#endif

#ifndef TESSERA_TESTS_TRANSPORT_BRUTE_FORCE_H
#define TESSERA_TESTS_TRANSPORT_BRUTE_FORCE_H

#include "mediator/shading/materials.h"
#include "mediator/shading/thin_walls.h"
#include "mediator/shading/triangle_points.h"

// Rays tested against every triangle, the same in C++ and on a device, so that only the transport can differ.
SHADING_BEGIN

struct Context {
    Scene scene;
    View view;
    float time;
};

#ifdef __cplusplus
inline void log_camera(IN(Context), IN(Ray)) {}
inline void log_miss(IN(Context)) {}
inline void log_emission(IN(Context), vec3, vec3) {}
inline void log_light(IN(Context), vec3, vec3) {}
inline void log_specular(IN(Context), bool, vec3) {}
struct Surface;
struct Receiver;
inline void log_hit(IN(Context), IN(Surface), vec3) {}
inline void log_receiver(IN(Context), IN(Receiver), IN(Ray)) {}
#endif

inline bool has_specular_trees(IN(Context) context) {
    return context.scene.instance_count > 0u;
}

inline vec3 placed(IN(Instance) instance, vec3 p) {
    return instance.linear * p + instance.translation;
}

// Möller and Trumbore 1997; `hit` is overwritten by closer hits.
inline bool meets(IN(Instance) instance, IN(Triangle) t, vec3 origin, vec3 direction, float near,
                  INOUT(Hit) hit) {
    const vec3 p = placed(instance, t.p);
    const vec3 edge1 = placed(instance, t.q) - p;
    const vec3 edge2 = placed(instance, t.r) - p;
    const vec3 across = cross(direction, edge2);
    const float determinant = dot(edge1, across);
    if (determinant == 0.0f) return false;
    const vec3 offset = origin - p;
    const float u = dot(offset, across) / determinant;
    const vec3 other = cross(offset, edge1);
    const float v = dot(direction, other) / determinant;
    const float distance = dot(edge2, other) / determinant;
    if (u < 0.0f || v < 0.0f || u + v > 1.0f || !(distance > near) || distance >= hit.distance) return false;
    hit.barycentric = vec2(u, v);
    hit.distance = distance;
    return true;
}

inline bool trace_instance(IN(Context) context, uint index, IN(Instance) instance, IN(Mesh) mesh, vec3 origin,
                           vec3 direction, IN(Sampler) numbers, IN(Skip) skip, INOUT(Hit) nearest) {
    bool found = false;
    for (uint i = 0u; i < mesh.triangle_count; ++i) {
        Hit hit = nearest;
        if (!meets(instance, triangle_of(mesh, mesh.triangles.items[i]), origin, direction, skip.near, hit))
            continue;
        if (skips(skip, index, hit.distance)) continue;
        if (instance.alpha_tested != 0u && !stops_at(context.scene, skip, index, i, hit.barycentric, numbers))
            continue;
        nearest = hit;
        nearest.instance = index;
        nearest.triangle = i;
        found = true;
    }
    return found;
}

inline bool trace_all(IN(Context) context, vec3 origin, vec3 direction, float far, IN(Sampler) numbers,
                      IN(Skip) skip, OUT(Hit) hit) {
    bool found = false;
    hit = Hit(0u, 0u, vec2(0.0f), far);
    for (uint i = 0u; i < context.scene.instance_count; ++i) {
        const uint mesh = context.scene.instances.items[i].mesh;
        if (trace_instance(context, i, context.scene.instances.items[i], context.scene.meshes.items[mesh],
                           origin, direction, numbers, skip, hit)) {
            found = true;
        }
    }
    return found;
}

inline bool trace_closest(IN(Context) context, IN(Ray) ray, IN(Sampler) numbers, IN(Skip) skip,
                          OUT(Hit) hit) {
    return trace_all(context, ray.origin, ray.direction, infinity(), numbers, skip, hit);
}

inline bool trace_occluded(IN(Context) context, vec3 origin, vec3 segment, float far, IN(Sampler) numbers,
                           OUT(ThinWalls) walls) {
    walls = no_thin_walls();
    Hit hit;
    Skip skip = skip_nothing();
    skip.unlit = true;
    return trace_all(context, origin, segment, far, numbers, skip, hit);
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_RASTER_H
#define TESSERA_MEDIATOR_SHADING_RASTER_H

#include "mediator/shading/bvh_ray.h"
#include "mediator/shading/camera.h"
#include "mediator/shading/paths.h"
#include "mediator/shading/triangle_points.h"

// Rasterised first hits. All pixels of one sample have the same subpixel offset, so that one sample of the
// picture is one rasterisation pass.
SHADING_BEGIN

// That offset: sample_pair of a pixel index outside of all pictures.
inline constexpr uint RasterPixel = 0xffffffffu;
inline vec2 raster_place(IN(View) view, uint64_t index) {
    return sample_pair(make_sampler(RasterPixel, RasterPixel, view.seed, index), CameraSet);
}

// Near plane. Depth is its ratio to the distance (reversed z), so a small value costs no precision; with
// 2^-40, depths and their slopes stay in the range of floats for distances below 2^60.
inline constexpr float RasterNear = 9.0949470e-13f;

// A square cell of the picture; a pass draws a part of one.
struct RasterCell {
    vec2 scale;  // x of the cell, -1 to 1, is scale x (x at distance 1 - the image centre) + shift
    vec2 shift;
    uint x;  // of its first pixel
    uint y;
    uint edge;  // pixels
    uint unused;
};

inline vec3 in_view(IN(View) view, vec3 from_eye) {
    return vec3(dot(from_eye, view.right), dot(from_eye, view.up), dot(from_eye, view.forward));
}

// In Vulkan clip space, with reversed depth.
inline vec4 raster_clip(IN(View) view, IN(RasterCell) cell, vec3 from_eye) {
    const vec3 v = in_view(view, from_eye);
    return vec4((v.x - view.image_center.x * v.z) * cell.scale.x + v.z * cell.shift.x,
                (v.y - view.image_center.y * v.z) * cell.scale.y + v.z * cell.shift.y, RasterNear, v.z);
}

inline vec3 seen_from(vec3 eye, IN(Instance) instance, vec3 corner) {
    return instance.linear * corner + (instance.translation - eye);
}

inline Triangle triangle_in(IN(Mesh) mesh, uint triangle) {
    return triangle_of(mesh, mesh.triangles.items[triangle]);
}

// Intersects a ray with a triangle that was rasterised at its pixel. Rasterisers snap vertices to subpixels,
// so the ray may just miss it: then the nearest edge is used.
inline Hit raster_hit(IN(Scene) scene, IN(Ray) ray, uint instance_index, uint triangle_index) {
    const Instance instance = scene.instances.items[instance_index];
    const Triangle t = triangle_in(scene.meshes.items[instance.mesh], triangle_index);
    const vec3 a = seen_from(ray.origin, instance, t.p);
    const vec3 b = seen_from(ray.origin, instance, t.q);
    const vec3 c = seen_from(ray.origin, instance, t.r);
    const BvhRay from_eye = bvh_ray(vec3(0.0f), ray.direction);
    const BvhWeights w = bvh_weights(from_eye, bvh_turned(from_eye.axis, a), bvh_turned(from_eye.axis, b),
                                     bvh_turned(from_eye.axis, c));
    const float side = w.a + w.b + w.c < 0.0f ? -1.0f : 1.0f;
    const vec3 inside =
        vec3(greater_of(side * w.a, 0.0f), greater_of(side * w.b, 0.0f), greater_of(side * w.c, 0.0f));
    const float sum = inside.x + inside.y + inside.z;
    Hit hit;
    hit.instance = instance_index;
    hit.triangle = triangle_index;
    hit.barycentric = sum > 0.0f && is_finite(sum) ? vec2(inside.y / sum, inside.z / sum) : vec2(1.0f / 3.0f);
    const vec3 corner_distances = vec3(dot(a, ray.direction), dot(b, ray.direction), dot(c, ray.direction));
    const vec3 normal = cross(b - a, c - a);
    hit.distance = dot(normal, a) / dot(normal, ray.direction);
    const float nearest = min(corner_distances.x, min(corner_distances.y, corner_distances.z));
    const float farthest = max(corner_distances.x, max(corner_distances.y, corner_distances.z));
    if (!(hit.distance >= nearest && hit.distance <= farthest)) {
        hit.distance = corner_distances.x * (1.0f - hit.barycentric.x - hit.barycentric.y) +
                       corner_distances.y * hit.barycentric.x + corner_distances.z * hit.barycentric.y;
    }
    return hit;
}

SHADING_END

#endif

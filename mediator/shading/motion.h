#ifndef TESSERA_MEDIATOR_SHADING_MOTION_H
#define TESSERA_MEDIATOR_SHADING_MOTION_H

#include "mediator/shading/scaling.h"
#include "mediator/shading/triangle_points.h"

// Instances, meshes and lights at a time, 0 to 1 over the shutter. Scenes without motion skip all of this.
SHADING_BEGIN

// A time between two motion keys.
struct KeyInterval {
    uint index;
    float fraction;  // of the interval
};

inline KeyInterval key_interval_at(uint steps, float time) {
    const float at = time * float(steps);
    const uint step = min(uint(at), steps - 1u);
    return KeyInterval(step, at - float(step));
}

inline Affine3x4 interpolate_transform(IN(Affine3x4) from, IN(Affine3x4) to, float fraction) {
    return Affine3x4(
        mat3(between(from.linear[0], to.linear[0], fraction), between(from.linear[1], to.linear[1], fraction),
             between(from.linear[2], to.linear[2], fraction)),
        between(from.translation, to.translation, fraction));
}

inline Affine3x4 transform_at(Affine3x4Array keys, uint first, uint steps, float time) {
    const KeyInterval interval = key_interval_at(steps, time);
    return interpolate_transform(keys.items[first + interval.index], keys.items[first + interval.index + 1u],
                                 interval.fraction);
}

// Transforms a ray to object space; its direction has any length. NaN if the transform is singular. By
// cofactors, scaled so that products stay in range; motion_error bounds the rounding.
inline Ray ray_in_object(IN(Affine3x4) place, vec3 origin, vec3 direction) {
    const mat3 m = place.linear;
    const float scale = unit_scale(extent_of(max(max(abs(m[0]), abs(m[1])), abs(m[2]))));
    const vec3 a = m[0] * scale, b = m[1] * scale, c = m[2] * scale;
    const vec3 x = cross(b, c), y = cross(c, a), z = cross(a, b);
    const float inverse = scale / dot(a, x);
    const vec3 from = origin - place.translation;
    return Ray(vec3(dot(x, from), dot(y, from), dot(z, from)) * inverse,
               vec3(dot(x, direction), dot(y, direction), dot(z, direction)) * inverse);
}

// The normals and the handedness of an Instance.
struct NormalTransform {
    mat3 normals;  // cofactors times a power of two
    float handedness;
};

inline NormalTransform normal_transform(IN(mat3) linear) {
    const float scale = unit_scale(extent_of(max(max(abs(linear[0]), abs(linear[1])), abs(linear[2]))));
    const vec3 x = linear[0] * scale;
    const vec3 y = linear[1] * scale;
    const vec3 z = linear[2] * scale;
    const vec3 across = cross(y, z);
    const float side = dot(x, across) < 0.0f ? -1.0f : 1.0f;
    return NormalTransform(mat3(side * across, side * cross(z, x), side * cross(x, y)), side);
}

inline bool is_static(IN(Scene) scene, int motion) {
    return (scene.features & FeatureMotion) == 0u || motion < 0;
}

inline Instance instance_in_motion(IN(Scene) scene, IN(Instance) instance, float time) {
    const Motion motion = scene.motions.items[instance.motion];
    const Affine3x4 place = transform_at(scene.transform_keys, motion.first_key, motion.key_intervals, time);
    Instance moved = instance;
    moved.linear = place.linear;
    moved.translation = place.translation;
    const NormalTransform turn = normal_transform(place.linear);
    moved.normals = turn.normals;
    moved.handedness = turn.handedness;
    return moved;
}

inline Instance instance_at(IN(Scene) scene, IN(Instance) instance, float time) {
    if (is_static(scene, instance.motion)) return instance;
    return instance_in_motion(scene, instance, time);
}

// Without FeatureMotion MeshDeforms is cleared, so that compilers remove the deformation code.
inline Mesh mesh_at(IN(Scene) scene, IN(Mesh) mesh, float time) {
    Mesh deformed = mesh;
    if ((scene.features & FeatureMotion) == 0u) {
        deformed.arrays = mesh.arrays & ~MeshDeforms;
        return deformed;
    }
    if ((mesh.arrays & MeshDeforms) == 0u) return deformed;
    const KeyInterval interval = key_interval_at(mesh.key_intervals, time);
    MeshKey from = scene.mesh_keys.items[mesh.first_key + interval.index];
    MeshKey to = scene.mesh_keys.items[mesh.first_key + interval.index + 1u];
    deformed.key_fraction = interval.fraction;
    deformed.positions = from.positions;
    deformed.normals = from.normals;
    deformed.next_positions = to.positions;
    deformed.next_normals = to.normals;
    return deformed;
}

// |v| x |w| with sums instead of differences: the rounding error of the cross product is proportional to it.
inline vec3 cross_magnitudes(vec3 v, vec3 w) {
    return vec3(v.y * w.z + v.z * w.y, v.z * w.x + v.x * w.z, v.x * w.y + v.y * w.x);
}

// The additional error of point_on for moving geometry, per axis. Interpolation: 4 roundings of the bounds
// over the keys, of transforms and vertices, both here and in ray traversal, which evaluates in another
// order. In addition rays use an inverse computed at the ray's time: its cofactors have 3 roundings of their
// cross_magnitudes each, then 3 of the sum, 1 of the division, 2 of the origin's offset; the determinant has
// 6 of its own sum of magnitudes, which scale the distance from the object's origin.
inline vec3 motion_error(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Triangle) t, vec2 b,
                         vec3 position) {
    if ((scene.features & FeatureMotion) == 0u) return vec3(0.0f);
    const mat3 m = mat3(abs(instance.linear[0]), abs(instance.linear[1]), abs(instance.linear[2]));
    vec3 error = vec3(0.0f);
    if ((mesh.arrays & MeshDeforms) != 0u)
        error = m * vec3(2.0f * rounding_bound(4.0f) * mesh.max_abs_position);
    if (instance.motion < 0) return error;
    const Motion motion = scene.motions.items[instance.motion];
    const vec3 object = abs(t.p) * abs(1.0f - b.x - b.y) + abs(t.q) * b.x + abs(t.r) * b.y;
    const float turned = motion.max_abs_linear * (object.x + object.y + object.z);
    error += 2.0f * rounding_bound(4.0f) * (motion.max_abs_translation + turned);
    // Scaled, as the inverse is, so that products stay in range.
    const float scale = unit_scale(extent_of(max(max(m[0], m[1]), m[2])));
    const mat3 unit = mat3(m[0] * scale, m[1] * scale, m[2] * scale);
    const vec3 x = cross_magnitudes(unit[1], unit[2]);
    const vec3 y = cross_magnitudes(unit[2], unit[0]);
    const vec3 z = cross_magnitudes(unit[0], unit[1]);
    const float determinant =
        abs(dot(instance.linear[0] * scale, cross(instance.linear[1] * scale, instance.linear[2] * scale)));
    if (!(determinant > 0.0f)) return error;
    const vec3 magnitude = abs(position) + abs(instance.translation);
    const vec3 back = unit * (vec3(dot(x, magnitude), dot(y, magnitude), dot(z, magnitude)) / determinant);
    const float stretch = dot(unit[0], x) / determinant;
    return error + rounding_bound(9.0f) * back + rounding_bound(6.0f) * stretch * (m * object);
}

// 1 / the square root of an emitter's area, as in Emitter; of an instance and a triangle at a time.
inline float inverse_root_area_of(IN(Scene) scene, IN(Emitter) emitter, IN(Instance) instance,
                                  IN(Triangle) t) {
    if ((scene.features & FeatureMotion) == 0u || emitter.inverse_root_area > 0.0f) {
        return emitter.inverse_root_area;
    }
    const vec3 q = instance.linear * (t.q - t.p);
    const vec3 r = instance.linear * (t.r - t.p);
    const float scale = unit_scale(extent_of(max(abs(q), abs(r))));
    const vec3 across = cross(q * scale, r * scale);
    // Twice the area. A lower limit avoids underflow; triangles below it lose energy.
    const float area2 = sqrt(greater_of(dot(across, across), 1e-36f));
    return scale * sqrt(2.0f / area2);
}

// Position and directions of a light that is no mesh.
inline LightSource light_in_motion(IN(Scene) scene, IN(LightSource) light, float time) {
    const Motion motion = scene.motions.items[light.motion];
    const Affine3x4 place = transform_at(scene.transform_keys, motion.first_key, motion.key_intervals, time);
    LightSource moved = light;
    moved.position = place.translation;
    moved.direction = direction_of(-place.linear[2], light.direction);
    moved.edge_u = direction_of(cross(moved.direction, place.linear[1]), light.edge_u);
    moved.edge_v = cross(moved.direction, moved.edge_u);
    return moved;
}

inline LightSource light_at(IN(Scene) scene, IN(LightSource) light, float time) {
    if (is_static(scene, light.motion)) return light;
    return light_in_motion(scene, light, time);
}

SHADING_END

#endif

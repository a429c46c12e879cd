#ifndef TESSERA_MEDIATOR_SHADING_MOTION_H
#define TESSERA_MEDIATOR_SHADING_MOTION_H

#include "mediator/shading/points.h"
#include "mediator/shading/scaling.h"

// Things as they are at a time, a share of the time that the shutter is open. A scene without motion is never
// asked for more than it has.
SHADING_BEGIN

// A time between two steps.
struct Moment {
    uint step;
    float share;  // of the way to the next
};

inline Moment moment_at(uint steps, float time) {
    const float at = time * float(steps);
    const uint step = min(uint(at), steps - 1u);
    return Moment(step, at - float(step));
}

inline Place place_between(IN(Place) from, IN(Place) to, float share) {
    return Place(
        mat3(between(from.linear[0], to.linear[0], share), between(from.linear[1], to.linear[1], share),
             between(from.linear[2], to.linear[2], share)),
        between(from.translation, to.translation, share));
}

inline Place place_at(PlaceArray places, uint first, uint steps, float time) {
    const Moment moment = moment_at(steps, time);
    return place_between(places.items[first + moment.step], places.items[first + moment.step + 1u],
                         moment.share);
}

// A ray in the space of what is at this place, its direction of any length; no numbers where there is no
// inverse. By cofactors, scaled so that products stay in range: motion_error bounds the rounding.
inline Ray ray_in_object(IN(Place) place, vec3 origin, vec3 direction) {
    const mat3 m = place.linear;
    const float scale = unit_scale(extent_of(max(max(abs(m[0]), abs(m[1])), abs(m[2]))));
    const vec3 a = m[0] * scale, b = m[1] * scale, c = m[2] * scale;
    const vec3 x = cross(b, c), y = cross(c, a), z = cross(a, b);
    const float inverse = scale / dot(a, x);
    const vec3 from = origin - place.translation;
    return Ray(vec3(dot(x, from), dot(y, from), dot(z, from)) * inverse,
               vec3(dot(x, direction), dot(y, direction), dot(z, direction)) * inverse);
}

// Cofactors, times a power of two, as Instance::normals has them.
inline mat3 turns_normals(IN(mat3) linear) {
    const float scale = unit_scale(extent_of(max(max(abs(linear[0]), abs(linear[1])), abs(linear[2]))));
    const vec3 x = linear[0] * scale;
    const vec3 y = linear[1] * scale;
    const vec3 z = linear[2] * scale;
    const vec3 across = cross(y, z);
    const float side = dot(x, across) < 0.0f ? -1.0f : 1.0f;
    return mat3(side * across, side * cross(z, x), side * cross(x, y));
}

inline bool stands_still(IN(Scene) scene, int motion) {
    return (scene.features & FeatureMotion) == 0u || motion < 0;
}

inline Instance moved_instance(IN(Scene) scene, IN(Instance) instance, float time) {
    const Motion motion = scene.motions.items[instance.motion];
    const Place place = place_at(scene.places, motion.first_place, motion.steps, time);
    Instance moved = instance;
    moved.linear = place.linear;
    moved.translation = place.translation;
    moved.normals = turns_normals(place.linear);
    return moved;
}

inline Instance instance_at(IN(Scene) scene, IN(Instance) instance, float time) {
    if (stands_still(scene, instance.motion)) return instance;
    return moved_instance(scene, instance, time);
}

// Where nothing moves, it does not bend: compilers see it.
inline Mesh mesh_at(IN(Scene) scene, IN(Mesh) mesh, float time) {
    Mesh bent = mesh;
    if ((scene.features & FeatureMotion) == 0u) {
        bent.arrays = mesh.arrays & ~MeshBends;
        return bent;
    }
    if ((mesh.arrays & MeshBends) == 0u) return bent;
    const Moment moment = moment_at(mesh.steps, time);
    MeshStep from = scene.mesh_steps.items[mesh.first_step + moment.step];
    MeshStep to = scene.mesh_steps.items[mesh.first_step + moment.step + 1u];
    bent.share = moment.share;
    bent.positions = from.positions;
    bent.normals = from.normals;
    bent.next_positions = to.positions;
    bent.next_normals = to.normals;
    return bent;
}

// |v| x |w| with sums for differences: what rounding of the cross product is in proportion to.
inline vec3 sizes_across(vec3 v, vec3 w) {
    return vec3(v.y * w.z + v.z * w.y, v.z * w.x + v.x * w.z, v.x * w.y + v.y * w.x);
}

// What point_on's bound lacks for what moves, per axis. Interpolation: 4 roundings of what a step may have,
// of the place and of the corners, here and where rays are traced, in another order. And rays come through an
// inverse that is made on the way: by its cofactors, each with 3 roundings of its sizes_across, then 3 of the
// sum, 1 of the division, 2 of the origin's place; the determinant has 6 of its own sum of sizes, which scale
// the way from the object's middle.
inline vec3 motion_error(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Triangle) t, vec2 b,
                         vec3 position) {
    if ((scene.features & FeatureMotion) == 0u) return vec3(0.0f);
    const mat3 m = mat3(abs(instance.linear[0]), abs(instance.linear[1]), abs(instance.linear[2]));
    vec3 error = vec3(0.0f);
    if ((mesh.arrays & MeshBends) != 0u) error = m * vec3(2.0f * rounding_bound(4.0f) * mesh.reach);
    if (instance.motion < 0) return error;
    const Motion motion = scene.motions.items[instance.motion];
    const vec3 object = abs(t.p) * abs(1.0f - b.x - b.y) + abs(t.q) * b.x + abs(t.r) * b.y;
    const float turned = motion.sizes * (object.x + object.y + object.z);
    error += 2.0f * rounding_bound(4.0f) * (motion.reach + turned);
    // Scaled, as the inverse is, so that products stay in range.
    const float scale = unit_scale(extent_of(max(max(m[0], m[1]), m[2])));
    const mat3 unit = mat3(m[0] * scale, m[1] * scale, m[2] * scale);
    const vec3 x = sizes_across(unit[1], unit[2]);
    const vec3 y = sizes_across(unit[2], unit[0]);
    const vec3 z = sizes_across(unit[0], unit[1]);
    const float determinant =
        abs(dot(instance.linear[0] * scale, cross(instance.linear[1] * scale, instance.linear[2] * scale)));
    if (!(determinant > 0.0f)) return error;
    const vec3 way = abs(position) + abs(instance.translation);
    const vec3 back = unit * (vec3(dot(x, way), dot(y, way), dot(z, way)) / determinant);
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
    // Twice the area. Of one too small for floats less light comes, as of a sphere too far away.
    const float area2 = sqrt(greater_of(dot(across, across), 1e-36f));
    return scale * sqrt(2.0f / area2);
}

// A light that is no mesh: its place, and the directions of one that has some.
inline LightSource moved_source(IN(Scene) scene, IN(LightSource) light, float time) {
    const Motion motion = scene.motions.items[light.motion];
    const Place place = place_at(scene.places, motion.first_place, motion.steps, time);
    LightSource moved = light;
    moved.position = place.translation;
    moved.direction = direction_of(-place.linear[2], light.direction);
    moved.edge_u = direction_of(cross(moved.direction, place.linear[1]), light.edge_u);
    moved.edge_v = cross(moved.direction, moved.edge_u);
    return moved;
}

inline LightSource light_at(IN(Scene) scene, IN(LightSource) light, float time) {
    if (stands_still(scene, light.motion)) return light;
    return moved_source(scene, light, time);
}

SHADING_END

#endif

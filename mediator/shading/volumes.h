#ifndef TESSERA_MEDIATOR_SHADING_VOLUMES_H
#define TESSERA_MEDIATOR_SHADING_VOLUMES_H

#include "mediator/shading/motion.h"
#include "mediator/shading/textures.h"

// Textures of bodies: looked up at points of the box around a geometry, in [0, 1] along each axis. Between the
// planes of a texture's lattice (through the middles of its texels if it is filtered, else through their edges)
// a texture is the product of linear functions, so that along a ray it is a cubic.
SHADING_BEGIN

// Coefficients are no more than this, which light does not get through: products stay finite.
inline constexpr float MostCoefficient = 1e18f;

// Slices beyond the ends are the last ones.
inline vec3 lookup_volume(IN(Scene) scene, IN(Texture) map, vec3 place) {
    const bool nearest = map.texture_filter == TextureNearest;
    const float half_texel = nearest ? 0.0f : 0.5f;
    const vec3 at = vec3(wrapped(place.x, map.wrap_s) * float(map.width),
                         wrapped(place.y, map.wrap_t) * float(map.height),
                         wrapped(place.z, WrapClamp) * float(map.depth)) -
                    half_texel;
    const vec3 first = floor(at);
    const vec3 share = nearest ? vec3(0.0f) : at - first;
    const uint taps = nearest ? 1u : 8u;
    vec3 sum = vec3(0.0f);
    KEEP_LOOP
    for (uint i = 0u; i < taps; ++i) {
        const int dx = int(i & 1u), dy = int((i >> 1u) & 1u), dz = int(i >> 2u);
        const uint column = wrapped_texel(int(first.x) + dx, map.width, map.wrap_s);
        const uint row = wrapped_texel(int(first.y) + dy, map.height, map.wrap_t);
        const uint slice = wrapped_texel(int(first.z) + dz, map.depth, WrapClamp);
        const float weight = (dx == 0 ? 1.0f - share.x : share.x) * (dy == 0 ? 1.0f - share.y : share.y) *
                             (dz == 0 ? 1.0f - share.z : share.z);
        const vec3 texel = vec3(texel_at(scene, map, (slice * map.height + row) * map.width + column));
        // What is no number or negative counts as 0.
        sum += weight * vec3(lesser_of(greater_of(texel.x, 0.0f), MostCoefficient),
                             lesser_of(greater_of(texel.y, 0.0f), MostCoefficient),
                             lesser_of(greater_of(texel.z, 0.0f), MostCoefficient));
    }
    return sum;
}

// A straight way through the box.
struct BoxRay {
    vec3 origin;
    vec3 direction;  // per metre of the world
};

inline BoxRay box_ray(IN(Instance) instance, IN(Body) body, vec3 origin, vec3 direction) {
    const Ray ray = ray_in_object(Place(instance.linear, instance.translation), origin, direction);
    return BoxRay((ray.origin - body.low) * body.inverse_size, ray.direction * body.inverse_size);
}

// Texture coordinates of a point of the box, and of a direction.
inline vec3 volume_place(IN(TextureUse) use, vec3 at) {
    const float v = 1.0f - at.y;
    return vec3(use.row_u.x * at.x + use.row_u.y * v + use.offset.x,
                use.row_v.x * at.x + use.row_v.y * v + use.offset.y, at.z);
}
inline vec3 volume_direction(IN(TextureUse) use, vec3 way) {
    return vec3(use.row_u.x * way.x - use.row_u.y * way.y, use.row_v.x * way.x - use.row_v.y * way.y, way.z);
}

// Where a coordinate from + step x t comes to the next whole number after `near`.
inline float next_plane(float from, float step, float near) {
    if (step == 0.0f) return infinity();
    const float at = from + step * near;
    const float side = step > 0.0f ? 1.0f : -1.0f;
    const float plane = step > 0.0f ? floor(at) + 1.0f : -floor(-at) - 1.0f;
    const float next = (plane - from) / step;
    return next > near ? next : (plane + side - from) / step;
}

inline float next_cell(IN(Scene) scene, IN(Body) body, IN(BoxRay) ray, float near) {
    float next = infinity();
    KEEP_LOOP
    for (uint i = 0u; i < BodyTextureCount; ++i) {
        const TextureUse use = body.textures[i];
        if (use.texture < 0) continue;
        Texture map = scene.textures.items[use.texture];
        const vec3 size = vec3(float(map.width), float(map.height), float(map.depth));
        const float shift = map.texture_filter == TextureNearest ? 0.0f : 0.5f;
        const vec3 from = volume_place(use, ray.origin) * size - shift;
        const vec3 step = volume_direction(use, ray.direction) * size;
        next = lesser_of(next, next_plane(from.x, step.x, near));
        next = lesser_of(next, next_plane(from.y, step.y, near));
        if (map.depth > 1u) next = lesser_of(next, next_plane(from.z, step.z, near));
    }
    return next;
}

SHADING_END

#endif

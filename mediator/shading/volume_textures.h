#ifndef TESSERA_MEDIATOR_SHADING_VOLUME_TEXTURES_H
#define TESSERA_MEDIATOR_SHADING_VOLUME_TEXTURES_H

#include "mediator/shading/motion.h"
#include "mediator/shading/textures.h"

// Volume textures of media, looked up in the mesh's bounding box, in [0, 1] along each axis. Between the
// planes of a texture's grid (through the centres of its texels if it is filtered, else through their edges)
// a texture is trilinear, so that along a ray it is a cubic.
SHADING_BEGIN

// Upper limit of coefficients, opaque at any scale; keeps products finite.
inline constexpr float MaxCoefficient = 1e18f;

// Slices are clamped.
inline vec3 lookup_volume(IN(Scene) scene, IN(Texture) map, vec3 place) {
    const bool nearest = map.texture_filter == TextureNearest;
    const float half_texel = nearest ? 0.0f : 0.5f;
    const vec3 at = vec3(wrapped(place.x, map.wrap_s) * float(map.width),
                         wrapped(place.y, map.wrap_t) * float(map.height),
                         wrapped(place.z, WrapClamp) * float(map.depth)) -
                    half_texel;
    const vec3 first = floor(at);
    const vec3 fraction = nearest ? vec3(0.0f) : at - first;
    const uint taps = nearest ? 1u : 8u;
    vec3 sum = vec3(0.0f);
    NO_UNROLL
    for (uint i = 0u; i < taps; ++i) {
        const int dx = int(i & 1u), dy = int((i >> 1u) & 1u), dz = int(i >> 2u);
        const uint column = wrapped_texel(int(first.x) + dx, map.width, map.wrap_s);
        const uint row = wrapped_texel(int(first.y) + dy, map.height, map.wrap_t);
        const uint slice = wrapped_texel(int(first.z) + dz, map.depth, WrapClamp);
        const float weight = (dx == 0 ? 1.0f - fraction.x : fraction.x) *
                             (dy == 0 ? 1.0f - fraction.y : fraction.y) *
                             (dz == 0 ? 1.0f - fraction.z : fraction.z);
        const vec3 texel = vec3(texel_at(scene, map, (slice * map.height + row) * map.width + column));
        // NaN and negative values count as 0.
        sum += weight * vec3(lesser_of(greater_of(texel.x, 0.0f), MaxCoefficient),
                             lesser_of(greater_of(texel.y, 0.0f), MaxCoefficient),
                             lesser_of(greater_of(texel.z, 0.0f), MaxCoefficient));
    }
    return sum;
}

// A ray in box coordinates.
struct BoxRay {
    vec3 origin;
    vec3 direction;  // per metre of the world
};

inline BoxRay box_ray(IN(Instance) instance, IN(Medium) medium, vec3 origin, vec3 direction) {
    const Ray ray = ray_in_object(Affine3x4(instance.linear, instance.translation), origin, direction);
    return BoxRay((ray.origin - medium.low) * medium.inverse_size, ray.direction * medium.inverse_size);
}

// Texture coordinates of a point of the box, and of a direction.
inline vec3 volume_place(IN(TextureUse) use, vec3 at) {
    const float v = 1.0f - at.y;
    return vec3(use.row_u.x * at.x + use.row_u.y * v + use.offset.x,
                use.row_v.x * at.x + use.row_v.y * v + use.offset.y, at.z);
}
inline vec3 volume_direction(IN(TextureUse) use, vec3 direction) {
    return vec3(use.row_u.x * direction.x - use.row_u.y * direction.y,
                use.row_v.x * direction.x - use.row_v.y * direction.y, direction.z);
}

// The t at which the coordinate from + step x t crosses the next integer after `near`.
inline float next_plane(float from, float step, float near) {
    if (step == 0.0f) return infinity();
    const float at = from + step * near;
    const float side = step > 0.0f ? 1.0f : -1.0f;
    const float plane = step > 0.0f ? floor(at) + 1.0f : -floor(-at) - 1.0f;
    const float next = (plane - from) / step;
    return next > near ? next : (plane + side - from) / step;
}

inline float next_cell(IN(Scene) scene, IN(Medium) medium, IN(BoxRay) ray, float near) {
    float next = infinity();
    NO_UNROLL
    for (uint i = 0u; i < MediumTextureCount; ++i) {
        const TextureUse use = medium.textures[i];
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

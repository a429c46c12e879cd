#ifndef TESSERA_MEDIATOR_SHADING_TEXTURES_H
#define TESSERA_MEDIATOR_SHADING_TEXTURES_H

#include "mediator/shading/maths.h"
#include "mediator/shading/records.h"

// Textures are stored in buffers and filtered in software: not all devices support non-uniform texture
// indexing, and hardware filtering has lower precision.
SHADING_BEGIN

// A texture coordinate in [0, 1]; 1 only if it does not repeat. Beyond 1e9 a float has no fractional bits:
// returns 0.
inline float wrapped(float u, uint wrap) {
    if (!(abs(u) < 1e9f)) return 0.0f;
    if (wrap == WrapClamp) return clamp(u, 0.0f, 1.0f);
    if (wrap == WrapRepeat) return u - floor(u);
    const float there_and_back = u - 2.0f * floor(0.5f * u);
    return min(there_and_back, 2.0f - there_and_back);
}

// Wraps a texel index of -1 to size: one texel beyond an edge is the opposite edge if the texture repeats.
inline uint wrapped_texel(int i, uint size, uint wrap) {
    const int last = int(size) - 1;
    if (wrap != WrapRepeat) return uint(clamp(i, 0, last));
    return uint(i < 0 ? last : (i > last ? 0 : i));
}

inline vec4 texel_at(IN(Scene) scene, IN(Texture) map, uint index) {
    if (map.format == TexelRgbFloat) {
        return vec4(float_from_bits(map.texels.items[3u * index]),
                    float_from_bits(map.texels.items[3u * index + 1u]),
                    float_from_bits(map.texels.items[3u * index + 2u]), 1.0f);
    }
    const uint rgba = map.texels.items[index];
    if (map.format == TexelRgba8Signed) {
        // Signed bytes, sign-extended by shifts; -128 counts as -127.
        const vec4 bytes = vec4(float(int(rgba << 24u) >> 24), float(int(rgba << 16u) >> 24),
                                float(int(rgba << 8u) >> 24), float(int(rgba) >> 24));
        return max(bytes * (1.0f / 127.0f), vec4(-1.0f));
    }
    const uint r = rgba & 255u, g = (rgba >> 8u) & 255u, b = (rgba >> 16u) & 255u;
    const float unit = 1.0f / 255.0f;
    const float alpha = float(rgba >> 24u) * unit;
    if (map.format == TexelRgba8Srgb) {
        return vec4(scene.srgb.items[r], scene.srgb.items[g], scene.srgb.items[b], alpha);
    }
    return vec4(float(r) * unit, float(g) * unit, float(b) * unit, alpha);
}

// Linear values (sRGB decoded before filtering), bilinear or nearest; RgbFloat has alpha 1. The loop is
// deliberate: unrolled lookups are a large part of a kernel's code. `first`: index of the
// first texel.
inline vec4 lookup_from(IN(Scene) scene, IN(Texture) map, uint first, vec2 uv) {
    const bool nearest = map.texture_filter == TextureNearest;
    const float half_texel = nearest ? 0.0f : 0.5f;
    const float x = wrapped(uv.x, map.wrap_s) * float(map.width) - half_texel;
    const float y = wrapped(uv.y, map.wrap_t) * float(map.height) - half_texel;
    const float fx = floor(x), fy = floor(y);
    const float wx = nearest ? 0.0f : x - fx;
    const float wy = nearest ? 0.0f : y - fy;
    const uint taps = nearest ? 1u : 4u;
    vec4 sum = vec4(0.0f);
    NO_UNROLL
    for (uint i = 0u; i < taps; ++i) {
        const int dx = int(i & 1u), dy = int(i >> 1u);
        const uint column = wrapped_texel(int(fx) + dx, map.width, map.wrap_s);
        const uint row = wrapped_texel(int(fy) + dy, map.height, map.wrap_t);
        const float weight = (dx == 0 ? 1.0f - wx : wx) * (dy == 0 ? 1.0f - wy : wy);
        sum += weight * texel_at(scene, map, first + row * map.width + column);
    }
    return sum;
}

inline vec4 lookup(IN(Scene) scene, IN(Texture) map, vec2 uv) {
    return lookup_from(scene, map, 0u, uv);
}

// Trilinear lookup with a footprint of this area in texture coordinates: between the two closest mip levels.
// A footprint of a texel or less uses the full-size image.
inline vec4 lookup_wide(IN(Scene) scene, IN(Texture) map, vec2 uv, float area) {
    const float covered = area * float(map.width) * float(map.height);
    float wanted = 0.0f;
    if (map.level_count > 0u && covered > 1.0f) {
        wanted = lesser_of(0.5f * 1.44269504f * logarithm(lesser_of(covered, 1e30f)), float(map.level_count));
    }
    const uint finer = uint(wanted);
    const float coarser_weight = wanted - float(finer);
    const uint last = coarser_weight > 0.0f ? finer + 1u : finer;
    Texture level = map;
    uint first = 0u;
    vec4 sum = vec4(0.0f);
    NO_UNROLL
    for (uint i = 0u; i <= last; ++i) {
        if (i >= finer) {
            const vec4 value = lookup_from(scene, level, first, uv);
            sum += (i == finer ? 1.0f - coarser_weight : coarser_weight) * value;
        }
        first = i == 0u ? 0u : first + level.width * level.height;
        level.texels = map.levels;
        level.width = max(level.width >> 1u, 1u);
        level.height = max(level.height >> 1u, 1u);
    }
    return sum;
}

inline bool is_used(IN(Scene) scene, IN(TextureUse) use) {
    return (scene.features & FeatureTextures) != 0u && use.texture >= 0;
}

// Of this texture coordinate set; 0 if the mesh does not have it.
inline vec2 tex_coord_at(IN(Mesh) mesh, uint set, uvec3 corners, vec2 b) {
    if ((mesh.arrays & (set == 0u ? MeshTexCoords : MeshTexCoords1)) == 0u) return vec2(0.0f);
    Vec2Array coords = mesh.tex_coords;
    if (set != 0u) coords = mesh.tex_coords_1;
    return coords.items[corners.x] * (1.0f - b.x - b.y) + coords.items[corners.y] * b.x +
           coords.items[corners.z] * b.y;
}

// `area`: of the footprint in texture coordinates; 0: a point.
inline vec4 lookup_use(IN(Scene) scene, IN(TextureUse) use, vec2 uv, float area) {
    const vec2 place = vec2(use.row_u.x * uv.x + use.row_u.y * uv.y + use.offset.x,
                            use.row_v.x * uv.x + use.row_v.y * uv.y + use.offset.y);
    const float stretch = abs(use.row_u.x * use.row_v.y - use.row_u.y * use.row_v.x);
    return lookup_wide(scene, scene.textures.items[use.texture], place, area * stretch);
}

// Area of the parallelogram over two edges of a triangle, in texture coordinates.
inline float tex_area(IN(Mesh) mesh, uint set, uvec3 corners) {
    const vec2 first = tex_coord_at(mesh, set, corners, vec2(0.0f));
    const vec2 p = tex_coord_at(mesh, set, corners, vec2(1.0f, 0.0f)) - first;
    const vec2 q = tex_coord_at(mesh, set, corners, vec2(0.0f, 1.0f)) - first;
    return abs(p.x * q.y - p.y * q.x);
}

// `footprint`: as a fraction of that parallelogram (ray_cones.h); 0: a point.
inline vec4 texel_of(IN(Scene) scene, IN(TextureUse) use, IN(Mesh) mesh, uvec3 corners, vec2 b,
                     float footprint) {
    const float area = footprint > 0.0f ? footprint * tex_area(mesh, use.set, corners) : 0.0f;
    return lookup_use(scene, use, tex_coord_at(mesh, use.set, corners, b), area);
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_TEXTURES_H
#define TESSERA_MEDIATOR_SHADING_TEXTURES_H

#include "mediator/shading/records.h"

// Textures lie in buffers and are sampled here: not every device lets a shader choose among many of its own,
// and theirs filter with fewer bits.
SHADING_BEGIN

// Any integer coordinate to a texel.
inline uint wrapped(int i, uint size, uint wrap) {
    if (uint(i) < size) return uint(i);
    if (wrap == WrapClamp) return i < 0 ? 0u : size - 1u;
    const uint steps = i < 0 ? uint(-1 - i) : uint(i);  // from texel 0 on, or backwards from texel -1
    const uint turns = steps / size;
    const uint rest = steps - turns * size;
    const bool backwards = wrap == WrapMirror ? (turns & 1u) == 1u : i < 0;
    return backwards ? size - 1u - rest : rest;
}

inline vec4 texel_at(IN(Scene) scene, IN(Texture) map, int x, int y) {
    const uint index = wrapped(y, map.height, map.wrap_t) * map.width + wrapped(x, map.width, map.wrap_s);
    if (map.format == TexelRgbFloat) {
        return vec4(float_from_bits(map.texels.items[3u * index]),
                    float_from_bits(map.texels.items[3u * index + 1u]),
                    float_from_bits(map.texels.items[3u * index + 2u]), 1.0f);
    }
    const uint rgba = map.texels.items[index];
    const uint r = rgba & 255u, g = (rgba >> 8u) & 255u, b = (rgba >> 16u) & 255u;
    const float unit = 1.0f / 255.0f;
    const float alpha = float(rgba >> 24u) * unit;
    if (map.format == TexelRgba8Srgb) {
        return vec4(scene.srgb.items[r], scene.srgb.items[g], scene.srgb.items[b], alpha);
    }
    return vec4(float(r) * unit, float(g) * unit, float(b) * unit, alpha);
}

// Beyond 1e9 a float has no fraction left, and integers come to their end: any texel is as good.
inline float sane_coordinate(float x) {
    return x > -1e9f && x < 1e9f ? x : 0.0f;
}

// Linear values (sRGB decoded before filtering), bilinear or nearest; RgbFloat has alpha 1.
inline vec4 lookup(IN(Scene) scene, IN(Texture) map, vec2 uv) {
    const float x = sane_coordinate(uv.x * float(map.width));
    const float y = sane_coordinate(uv.y * float(map.height));
    if (map.texture_filter == TextureNearest) return texel_at(scene, map, int(floor(x)), int(floor(y)));
    const float fx = floor(x - 0.5f), fy = floor(y - 0.5f);
    const float wx = x - 0.5f - fx, wy = y - 0.5f - fy;
    vec4 sum = vec4(0.0f);
    // A loop that stays one: compilers of shaders take long for text that is there many times.
    KEEP_LOOP
    for (int corner = 0; corner < 4; ++corner) {
        const bool right = (corner & 1) != 0, below = corner > 1;
        const vec4 texel = texel_at(scene, map, int(fx) + (right ? 1 : 0), int(fy) + (below ? 1 : 0));
        sum += texel * ((right ? wx : 1.0f - wx) * (below ? wy : 1.0f - wy));
    }
    return sum;
}

// White where no texture is used.
inline vec4 lookup_use(IN(Scene) scene, IN(TextureUse) use, vec2 uv) {
    if (use.texture < 0) return vec4(1.0f);
    const vec2 place = vec2(use.row_u.x * uv.x + use.row_u.y * uv.y + use.offset.x,
                            use.row_v.x * uv.x + use.row_v.y * uv.y + use.offset.y);
    return lookup(scene, scene.textures.items[use.texture], place);
}

SHADING_END

#endif

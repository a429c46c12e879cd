#ifndef TESSERA_MEDIATOR_SHADING_LOOKS_H
#define TESSERA_MEDIATOR_SHADING_LOOKS_H

#include "mediator/shading/bsdf.h"
#include "mediator/shading/materials.h"

// A material's factors times its textures at a point (bsdf.h: Look). Normals are not here: surfaces.h.
SHADING_BEGIN

inline bool has_extras(IN(Scene) scene, IN(Material) material) {
    return (scene.features & FeatureExtras) != 0u && material.extras >= 0;
}

// The texel, or white where there is no texture.
inline vec4 texel_or_white(IN(Scene) scene, IN(TextureUse) use, IN(Mesh) mesh, uvec3 corners, vec2 b,
                           float footprint) {
    if (!is_used(scene, use)) return vec4(1.0f);
    return texel_of(scene, use, mesh, corners, b, footprint);
}

// KHR_materials_anisotropy: roughness along the direction of anisotropy grows to 1.
inline vec2 stretched_alpha(float alpha, float anisotropy) {
    return vec2(alpha + (1.0f - alpha) * anisotropy * anisotropy, alpha);
}

// What the direction and the strength of anisotropy are: cosine and sine of the angle to the tangent, and the
// strength.
inline vec3 anisotropy_at(IN(Scene) scene, IN(MaterialExtras) extras, IN(Mesh) mesh, uvec3 corners, vec2 b,
                          float footprint) {
    const vec2 turn = extras.anisotropy_direction;
    if (!is_used(scene, extras.anisotropy_texture)) return vec3(turn.x, turn.y, extras.anisotropy);
    const vec4 texel = texel_of(scene, extras.anisotropy_texture, mesh, corners, b, footprint);
    const vec2 way = vec2(2.0f * texel.x - 1.0f, 2.0f * texel.y - 1.0f);
    const float length2 = dot(way, way);
    const float strength = extras.anisotropy * texel.z;
    if (!(length2 > 0.0f)) return vec3(turn.x, turn.y, strength);
    const vec2 from = way / sqrt(length2);
    return vec3(from.x * turn.x - from.y * turn.y, from.x * turn.y + from.y * turn.x, strength);
}

// `index`: of the extras. They are read where they lie: a copy would have to be kept for the loop.
inline void add_extras(INOUT(Look) look, IN(Scene) scene, uint index, IN(Mesh) mesh, uvec3 corners, vec2 b,
                       float footprint) {
    const bool iridescent = (scene.features & FeatureIridescence) != 0u;
    const uint count = iridescent ? ExtrasTextureCount : ExtrasIridescence;
    vec4 texels[ExtrasTextureCount];
    KEEP_LOOP
    for (uint i = 0u; i < count; ++i) {
        texels[i] = texel_or_white(scene, scene.extras.items[index].textures[i], mesh, corners, b, footprint);
    }
    const MaterialExtras extras = scene.extras.items[index];
    look.specular = extras.specular * texels[ExtrasSpecular].w;
    look.specular_color = extras.specular_color * vec3(texels[ExtrasSpecularColor]);
    look.transmission *= texels[ExtrasTransmission].x;
    look.coat = extras.coat * texels[ExtrasCoat].x;
    look.coat_roughness = extras.coat_roughness * texels[ExtrasCoatRoughness].y;
    look.sheen_color = extras.sheen_color * vec3(texels[ExtrasSheenColor]);
    look.sheen_roughness = extras.sheen_roughness * texels[ExtrasSheenRoughness].w;
    if (look.coat > 0.0f) look.lobes |= scene.features & FeatureCoat;
    if (largest(look.sheen_color) > 0.0f) look.lobes |= scene.features & FeatureSheen;
    if (iridescent && extras.iridescence > 0.0f) {
        const vec2 ends = extras.film_thickness;
        look.film = make_film(extras.iridescence * texels[ExtrasIridescence].x, look.specular,
                              extras.film_index, ends.x + (ends.y - ends.x) * texels[ExtrasThickness].y);
        if (look.film.strength > 0.0f) look.lobes |= FeatureIridescence;
    }
    if (extras.anisotropy > 0.0f) {
        const float strength = anisotropy_at(scene, extras, mesh, corners, b, footprint).z;
        look.alpha = stretched_alpha(look.alpha.x, strength);
    }
}

// `front`: of the face that is seen. Bodies are solid unless their walls are thin: behind the front is glass,
// behind the back is what it is in. `n`: the material's index of refraction relative to that; 0 stands for
// infinity.
inline Look look_at(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uvec3 corners, vec2 b,
                    float footprint, vec3 base_color, bool front, float n) {
    const vec4 texel =
        texel_or_white(scene, material.metallic_roughness_texture, mesh, corners, b, footprint);
    const float eta = front || n == 0.0f || material.thin != 0u ? n : 1.0f / n;
    Look look = plain_look(base_color, material.metallic * texel.z, material.roughness * texel.y,
                           material.transmission, n, eta);
    look.thin = material.thin;
    look.lobes = scene.features & FeatureRoughGlass;
    if (has_extras(scene, material)) {
        add_extras(look, scene, uint(material.extras), mesh, corners, b, footprint);
    }
    return look;
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_MATERIAL_EVAL_H
#define TESSERA_MEDIATOR_SHADING_MATERIAL_EVAL_H

#include "mediator/shading/bsdf.h"
#include "mediator/shading/materials.h"

// A material's factors times its textures at a point (bsdf.h: MaterialSample). Normals are not here:
// surfaces.h.
SHADING_BEGIN

inline bool has_extras(IN(Scene) scene, IN(Material) material) {
    return (scene.features & FeatureExtras) != 0u && material.extras >= 0;
}

// The texel, or white if there is no texture. A point: light is no linear function of what is looked up here
// (ray_cones.h).
inline vec4 texel_or_white(IN(Scene) scene, IN(TextureUse) use, IN(Mesh) mesh, uvec3 corners, vec2 b) {
    if (!is_used(scene, use)) return vec4(1.0f);
    return texel_of(scene, use, mesh, corners, b, 0.0f);
}

// KHR_materials_anisotropy: roughness along the direction of anisotropy grows to 1.
inline vec2 stretched_alpha(float alpha, float anisotropy) {
    return vec2(alpha + (1.0f - alpha) * anisotropy * anisotropy, alpha);
}

// Direction and strength of anisotropy: cosine and sine of the angle to the tangent, and the strength.
inline vec3 anisotropy_at(IN(Scene) scene, IN(MaterialExtras) extras, IN(Mesh) mesh, uvec3 corners, vec2 b) {
    const vec2 turn = extras.anisotropy_direction;
    if (!is_used(scene, extras.anisotropy_texture)) return vec3(turn.x, turn.y, extras.anisotropy);
    const vec4 texel = texel_of(scene, extras.anisotropy_texture, mesh, corners, b, 0.0f);
    const vec2 direction = vec2(2.0f * texel.x - 1.0f, 2.0f * texel.y - 1.0f);
    const float length2 = dot(direction, direction);
    const float strength = extras.anisotropy * texel.z;
    if (!(length2 > 0.0f)) return vec3(turn.x, turn.y, strength);
    const vec2 from = direction / sqrt(length2);
    return vec3(from.x * turn.x - from.y * turn.y, from.x * turn.y + from.y * turn.x, strength);
}

// `index`: of the extras, read in place: a copy would occupy registers during the loop.
inline void add_extras(INOUT(MaterialSample) material_sample, IN(Scene) scene, uint index, IN(Mesh) mesh,
                       uvec3 corners, vec2 b) {
    const bool iridescent = (scene.features & FeatureIridescence) != 0u;
    const uint count = iridescent ? ExtrasTextureCount : ExtrasIridescence;
    vec4 texels[ExtrasTextureCount];
    NO_UNROLL
    for (uint i = 0u; i < count; ++i) {
        texels[i] = texel_or_white(scene, scene.extras.items[index].textures[i], mesh, corners, b);
    }
    CONST_REF(MaterialExtras) extras = scene.extras.items[index];
    material_sample.specular = extras.specular * texels[ExtrasSpecular].w;
    material_sample.specular_color = extras.specular_color * vec3(texels[ExtrasSpecularColor]);
    material_sample.transmission *= texels[ExtrasTransmission].x;
    material_sample.coat = extras.coat * texels[ExtrasCoat].x;
    material_sample.coat_roughness = extras.coat_roughness * texels[ExtrasCoatRoughness].y;
    material_sample.sheen_color = extras.sheen_color * vec3(texels[ExtrasSheenColor]);
    material_sample.sheen_roughness = extras.sheen_roughness * texels[ExtrasSheenRoughness].w;
    if (material_sample.coat > 0.0f) material_sample.lobes |= scene.features & FeatureCoat;
    if (largest(material_sample.sheen_color) > 0.0f) material_sample.lobes |= scene.features & FeatureSheen;
    if (iridescent && extras.iridescence > 0.0f) {
        const vec2 ends = extras.film_thickness;
        material_sample.film =
            make_film(extras.iridescence * texels[ExtrasIridescence].x, material_sample.specular,
                      extras.film_index, ends.x + (ends.y - ends.x) * texels[ExtrasThickness].y);
        if (material_sample.film.strength > 0.0f) material_sample.lobes |= FeatureIridescence;
    }
    if (extras.anisotropy > 0.0f) {
        const float strength = anisotropy_at(scene, extras, mesh, corners, b).z;
        material_sample.alpha = stretched_alpha(material_sample.alpha.x, strength);
    }
}

// `front`: whether the front face is hit. Meshes are solid unless thin-walled: glass is behind the front, the
// outside behind the back. `n`: the material's index of refraction relative to the outside; 0 = infinite.
inline MaterialSample evaluate_material(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uvec3 corners,
                                        vec2 b, vec3 base_color, bool front, float n) {
    const vec4 texel = texel_or_white(scene, material.metallic_roughness_texture, mesh, corners, b);
    const float eta = front || n == 0.0f || material.thin != 0u ? n : 1.0f / n;
    MaterialSample material_sample = default_material_sample(
        base_color, material.metallic * texel.z, material.roughness * texel.y, material.transmission, n, eta);
    material_sample.thin = material.thin;
    material_sample.lobes = scene.features & FeatureRoughGlass;
    if (has_extras(scene, material)) {
        add_extras(material_sample, scene, uint(material.extras), mesh, corners, b);
    }
    return material_sample;
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_MATERIALS_H
#define TESSERA_MEDIATOR_SHADING_MATERIALS_H

#include "mediator/shading/sobol.h"
#include "mediator/shading/textures.h"

// What a material is like at a point of an instance's triangle. `b`: barycentric weights of the second and
// third vertex.
SHADING_BEGIN

inline bool emits(IN(Material) material) {
    return material.emission.x > 0.0f || material.emission.y > 0.0f || material.emission.z > 0.0f;
}

// White where there are none.
inline vec4 vertex_color(IN(Mesh) mesh, uvec3 corners, vec2 b) {
    if ((mesh.arrays & MeshColors) == 0u) return vec4(1.0f);
    return mesh.colors.items[corners.x] * (1.0f - b.x - b.y) + mesh.colors.items[corners.y] * b.x +
           mesh.colors.items[corners.z] * b.y;
}

inline vec4 base_color_at(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uvec3 corners, vec2 b,
                          float footprint) {
    vec4 color = material.base_color;
    if (is_used(scene, material.base_color_texture)) {
        color *= texel_of(scene, material.base_color_texture, mesh, corners, b, footprint);
    }
    if ((mesh.arrays & MeshColors) != 0u) color *= vertex_color(mesh, corners, b);
    return color;
}

// CommonSurfaceShader: by its own texture, and not that of the diffuse colour.
inline float shader_alpha(IN(Scene) scene, IN(Material) material, IN(Shader) shader, IN(Mesh) mesh,
                          uvec3 corners, vec2 b) {
    float alpha = material.base_color.w * vertex_color(mesh, corners, b).w;
    if (is_used(scene, shader.alpha_texture)) {
        const float texel = texel_of(scene, shader.alpha_texture, mesh, corners, b, 0.0f).w;
        alpha *= shader.inverts_alpha != 0u ? 1.0f - texel : texel;
    }
    return alpha;
}

// 1 for opaque materials.
inline float alpha_at(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uvec3 corners, vec2 b) {
    if (material.alpha_mode == AlphaOpaque) return 1.0f;
    if ((scene.features & FeatureShader) != 0u && material.shader >= 0) {
        return shader_alpha(scene, material, scene.shaders.items[material.shader], mesh, corners, b);
    }
    return base_color_at(scene, material, mesh, corners, b, 0.0f).w;
}

// At the point itself, however wide the path: light that is sampled and light that is found by chance have to
// be the same.
inline vec3 emission_at(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uvec3 corners, vec2 b) {
    if (!is_used(scene, material.emission_texture)) return material.emission;
    return material.emission * vec3(texel_of(scene, material.emission_texture, mesh, corners, b, 0.0f));
}

inline bool alpha_stops(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uint instance, uint triangle,
                        vec2 b, uint seed) {
    const float alpha = alpha_at(scene, material, mesh, mesh.triangles.items[triangle], b);
    if (material.alpha_mode == AlphaOpaque) return true;
    if (material.alpha_mode == AlphaMask) return alpha >= material.alpha_cutoff;
    return unit_float(hash_combine(hash_combine(seed, instance), triangle)) < alpha;
}

// Whether a surface with alpha stops a ray. Mask: by the cutoff. Blend: by a hash of the ray's seed and the
// triangle, so that the answer does not depend on the order in which triangles are visited; on average a
// share alpha of rays stops. The boundary of a body is met in any case, since whoever goes through comes into
// the body or out of it: whether there is a surface as well, passes_boundary says.
inline bool stops_at(IN(Scene) scene, uint instance, uint triangle, vec2 b, uint seed) {
    if ((scene.features & FeatureMedia) != 0u && scene.instances.items[instance].body >= 0) return true;
    return alpha_stops(scene, scene.materials.items[scene.instances.items[instance].material],
                       scene.meshes.items[scene.instances.items[instance].mesh], instance, triangle, b, seed);
}

SHADING_END

#endif

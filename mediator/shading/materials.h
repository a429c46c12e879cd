#ifndef TESSERA_MEDIATOR_SHADING_MATERIALS_H
#define TESSERA_MEDIATOR_SHADING_MATERIALS_H

#include "mediator/shading/rays.h"
#include "mediator/shading/sampler.h"
#include "mediator/shading/textures.h"

// Material properties at a point of an instance's triangle. `b`: barycentric weights of the second and
// third vertex.
SHADING_BEGIN

inline bool emits(IN(Material) material) {
    return material.emission.x > 0.0f || material.emission.y > 0.0f || material.emission.z > 0.0f;
}

// White if there are none.
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

// CommonSurfaceShader has its own alpha texture.
inline float shader_alpha(IN(Scene) scene, IN(Material) material, IN(SurfaceShaderParams) shader,
                          IN(Mesh) mesh, uvec3 corners, vec2 b) {
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
    if ((scene.features & FeatureSurfaceShader) != 0u && material.surface_shader >= 0) {
        return shader_alpha(scene, material, scene.surface_shaders.items[material.surface_shader], mesh,
                            corners, b);
    }
    return base_color_at(scene, material, mesh, corners, b, 0.0f).w;
}

// Without filtering by the ray cone: emission must be the same for light sampling and for BSDF sampling.
inline vec3 emission_at(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uvec3 corners, vec2 b) {
    if (!is_used(scene, material.emission_texture)) return material.emission;
    return material.emission * vec3(texel_of(scene, material.emission_texture, mesh, corners, b, 0.0f));
}

inline constexpr uint AlphaSet = 0u;  // of the sequence of one triangle

inline bool alpha_stops(IN(Scene) scene, IN(Material) material, IN(Mesh) mesh, uint instance, uint triangle,
                        vec2 b, IN(Sampler) numbers) {
    const float alpha = alpha_at(scene, material, mesh, mesh.triangles.items[triangle], b);
    if (material.alpha_mode == AlphaOpaque) return true;
    if (material.alpha_mode == AlphaMask) return alpha >= material.alpha_cutoff;
    const uint seed = hash_combine(hash_combine(numbers.seed, instance), triangle);
    return sample_pair(Sampler(numbers.index, seed), AlphaSet).x < alpha;
}

// Whether a surface with alpha, or an unlit one, stops a ray. Mask: by the cutoff. Blend: by a random number of its own for each
// triangle, stratified over the samples, so that the result does not depend on the order in which triangles
// are visited; a fraction alpha of the rays stops. Medium boundaries always stop rays, since crossing one changes the
// containing media; passes_boundary tests whether there is a surface as well.
inline bool stops_at(IN(Scene) scene, IN(Skip) skip, uint instance, uint triangle, vec2 b,
                     IN(Sampler) numbers) {
    if (skip.unlit && scene.materials.items[scene.instances.items[instance].material].unlit != 0u)
        return false;
    if ((scene.features & FeatureMedia) != 0u && scene.instances.items[instance].medium >= 0) return true;
    return alpha_stops(scene, scene.materials.items[scene.instances.items[instance].material],
                       scene.meshes.items[scene.instances.items[instance].mesh], instance, triangle, b,
                       numbers);
}

// Whether light may go straight through the instance, as through a pane of clear glass. On the way to a light
// such walls do not stop a ray but attenuate it (transport.h).
inline bool is_thin_wall(IN(Scene) scene, uint instance) {
    if ((scene.features & FeatureThinGlass) == 0u) return false;
    return (scene.materials.items[scene.instances.items[instance].material].thin & ThinClear) != 0u;
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_SURFACE_SHADER_EVAL_H
#define TESSERA_MEDIATOR_SHADING_SURFACE_SHADER_EVAL_H

#include "mediator/shading/bump.h"
#include "mediator/shading/material_eval.h"

// Evaluates CommonSurfaceShader at a point of a triangle (Schwenk 5.A.3): factors x texels, normal, frame.
SHADING_BEGIN

inline bool has_surface_shader(IN(Scene) scene, IN(Material) material) {
    return (scene.features & FeatureSurfaceShader) != 0u && material.surface_shader >= 0;
}

// Blinn's exponent of shininess 1, as X3D's Material has it.
inline constexpr float ExponentOfShininess = 128.0f;

// Index 0 = infinite.
inline float relative_index(float index, bool front) {
    return front || index == 0.0f ? index : 1.0f / index;
}

// `front`: whether the front face is hit; the inside is behind it. `index`: of the shader (material_eval.h,
// add_extras).
inline SurfaceShaderLobes shader_lobes_at(IN(Scene) scene, uint index, IN(Mesh) mesh, uvec3 corners, vec2 b,
                                          vec3 diffuse, bool front, float cos_out) {
    vec4 texels[SurfaceShaderTextureCount];
    NO_UNROLL
    for (uint i = 0u; i < SurfaceShaderTextureCount; ++i) {
        texels[i] = texel_or_white(scene, scene.surface_shaders.items[index].textures[i], mesh, corners, b);
    }
    const SurfaceShaderParams shader = scene.surface_shaders.items[index];
    const vec3 n = shader.index_of_refraction;
    const PerfectPart perfect =
        PerfectPart(shader.reflection * vec3(texels[SurfaceShaderReflection]),
                    shader.transmission * vec3(texels[SurfaceShaderTransmission]),
                    vec3(relative_index(n.x, front), relative_index(n.y, front), relative_index(n.z, front)),
                    shader.fresnel_blend);
    return make_shader_lobes(diffuse, shader.specular * vec3(texels[SurfaceShaderSpecular]),
                             shader.shininess * (ExponentOfShininess * texels[SurfaceShaderShininess].w),
                             perfect, cos_out);
}

// The tangent frame: by the texture coordinate sets that the shader names, else by the mesh's tangents, else
// along u of the normal map's set.
inline mat3 shader_frame(IN(Instance) instance, IN(SurfaceShaderParams) shader, IN(EdgesInWorld) edges,
                         IN(Mesh) mesh, uint set, uvec3 corners, vec2 b, vec3 normal) {
    vec4 given = tangent_at(instance, mesh, corners, b, normal);
    if (given.w == 0.0f) {
        given = along_u(edges, mesh, set, corners);
        // On the front; along_u uses the side given by the order of the corners.
        if (dot(edges.across, normal) < 0.0f) given.w = -given.w;
    }
    vec3 tangent = vec3(given);
    if (shader.tangent_set >= 0) tangent = gradient_of_u(edges, mesh, uint(shader.tangent_set), corners);
    const vec3 x = direction_of(tangent - normal * dot(normal, tangent), frame_around(normal)[0]);
    vec3 y = cross(normal, x) * given.w;
    if (shader.binormal_set >= 0) {
        const vec3 binormal = gradient_of_u(edges, mesh, uint(shader.binormal_set), corners);
        y = direction_of(binormal - normal * dot(normal, binormal), y);
    }
    return mat3(x, y, normal);
}

// The front's normal after normal map and height map; with both, heights are relative to the mapped normal.
inline vec3 shader_normal(IN(Scene) scene, IN(Instance) instance, IN(SurfaceShaderParams) shader,
                          IN(TextureUse) map, IN(Triangle) t, IN(Mesh) mesh, uvec3 corners, vec2 b,
                          vec3 normal) {
    const bool mapped = is_used(scene, map), raised = is_used(scene, shader.height_texture);
    if (!mapped && !raised) return normal;
    const EdgesInWorld edges = edges_in_world(instance, t);
    vec3 result = normal;
    if (mapped) {
        const vec3 texel = vec3(texel_of(scene, map, mesh, corners, b, 0.0f));
        const vec3 n = texel * shader.normal_scale + shader.normal_bias;
        if (shader.normal_space == NormalObject) {
            result = direction_of(instance.normals * n, normal);
        } else {
            const mat3 frame = shader_frame(instance, shader, edges, mesh, map.set, corners, b, normal);
            result = direction_of(frame * n, normal);
        }
    }
    if (raised) {
        const vec3 slope = height_gradient(scene, shader.height_texture, edges, mesh, corners, b);
        result = direction_of(result - slope * shader.height_scale, result);
    }
    return result;
}

SHADING_END

#endif

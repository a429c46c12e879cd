#ifndef TESSERA_MEDIATOR_SHADING_SHADER_LOOKS_H
#define TESSERA_MEDIATOR_SHADING_SHADER_LOOKS_H

#include "mediator/shading/bump.h"
#include "mediator/shading/looks.h"

// What CommonSurfaceShader is at a point of a triangle (Schwenk 5.A.3): factor x texel, normal, frame.
SHADING_BEGIN

inline bool has_shader(IN(Scene) scene, IN(Material) material) {
    return (scene.features & FeatureShader) != 0u && material.shader >= 0;
}

// Blinn's exponent of shininess 1, as X3D's Material has it.
inline constexpr float ExponentOfShininess = 128.0f;

// Index 0 stands for infinity.
inline float relative_index(float index, bool front) {
    return front || index == 0.0f ? index : 1.0f / index;
}

// `front`: of the face that is seen: behind the front is the inside. `index`: of the shader (looks.h,
// add_extras).
inline ShaderLobes shader_lobes_at(IN(Scene) scene, uint index, IN(Mesh) mesh, uvec3 corners, vec2 b,
                                   float footprint, vec3 diffuse, bool front, float cos_out) {
    vec4 texels[ShaderTextureCount];
    KEEP_LOOP
    for (uint i = 0u; i < ShaderTextureCount; ++i) {
        texels[i] =
            texel_or_white(scene, scene.shaders.items[index].textures[i], mesh, corners, b, footprint);
    }
    const Shader shader = scene.shaders.items[index];
    const vec3 n = shader.index_of_refraction;
    const PerfectPart perfect =
        PerfectPart(shader.reflection * vec3(texels[ShaderReflection]),
                    shader.transmission * vec3(texels[ShaderTransmission]),
                    vec3(relative_index(n.x, front), relative_index(n.y, front), relative_index(n.z, front)),
                    shader.fresnel_blend);
    return make_shader_lobes(diffuse, shader.specular * vec3(texels[ShaderSpecular]),
                             shader.shininess * (ExponentOfShininess * texels[ShaderShininess].w), perfect,
                             cos_out);
}

// x and y axes of the tangent frame, not yet at right angles to the normal: by the sets of texture
// coordinates that the shader names, else as the mesh says, else along u of the set of its normal map.
inline mat3 shader_frame(IN(Instance) instance, IN(Shader) shader, IN(EdgesInWorld) edges, IN(Mesh) mesh,
                         uint set, uvec3 corners, vec2 b, vec3 normal) {
    vec4 given = tangent_at(instance, mesh, corners, b, normal);
    if (given.w == 0.0f) {
        given = along_u(edges, mesh, set, corners);
        // Of the front; the triangle's own side is that of its corners' order.
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

// The normal of the front that normal map and height map make of the vertices'. Both may be there: heights
// stand on the normals.
inline vec3 shader_normal(IN(Scene) scene, IN(Instance) instance, IN(Shader) shader, IN(TextureUse) map,
                          IN(Triangle) t, IN(Mesh) mesh, uvec3 corners, vec2 b, float footprint,
                          vec3 normal) {
    const bool mapped = is_used(scene, map), raised = is_used(scene, shader.height_texture);
    if (!mapped && !raised) return normal;
    const EdgesInWorld edges = edges_in_world(instance, t);
    vec3 result = normal;
    if (mapped) {
        const vec3 texel = vec3(texel_of(scene, map, mesh, corners, b, footprint));
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

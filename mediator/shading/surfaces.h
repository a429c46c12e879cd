#ifndef TESSERA_MEDIATOR_SHADING_SURFACES_H
#define TESSERA_MEDIATOR_SHADING_SURFACES_H

#include "mediator/shading/materials.h"
#include "mediator/shading/points.h"
#include "mediator/shading/specular.h"

SHADING_BEGIN

// What a path needs to know of the point it has reached.
struct Surface {
    vec3 position;
    vec3 error;             // bound of the position's rounding error, per axis
    vec3 geometric_normal;  // of unit length, to the side the path came from
    mat3 frame;             // shading frame, third axis = shading normal, same side
    vec3 albedo;
    vec3 emission;
    Bsdf bsdf;          // of what is no perfect specular
    Specular specular;  // perfect mirror and smooth glass; directions in the world
    float rough_share;  // of the material that is no perfect specular
    uint object;        // id
    uint triangle;
    int light;  // index, if it is one
    bool scatters;
};

inline vec3 to_local(IN(Surface) surface, vec3 world) {
    return world * surface.frame;
}
inline vec3 to_world(IN(Surface) surface, vec3 local) {
    return surface.frame * local;
}

inline vec3 mapped_normal(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                          uvec3 corners, vec2 b, vec3 normal) {
    if ((scene.features & FeatureNormalMaps) == 0u || !is_used(scene, material.normal_texture)) return normal;
    const uint needed = MeshTangents | MeshTexCoords;
    if ((mesh.arrays & needed) != needed) return normal;
    const vec4 tangent4 = mesh.tangents.items[corners.x] * (1.0f - b.x - b.y) +
                          mesh.tangents.items[corners.y] * b.x + mesh.tangents.items[corners.z] * b.y;
    vec3 tangent = instance.linear * vec3(tangent4);
    tangent = direction_of(tangent - normal * dot(normal, tangent), vec3(0.0f));
    if (tangent == vec3(0.0f)) return normal;
    const vec3 bitangent = cross(normal, tangent) * (tangent4.w < 0.0f ? -1.0f : 1.0f);
    const vec3 texel = vec3(lookup_use(scene, material.normal_texture, tex_coord_at(mesh, corners, b)));
    vec3 n = 2.0f * texel - 1.0f;
    n.x *= material.normal_scale;
    n.y *= material.normal_scale;
    return direction_of(tangent * n.x + bitangent * n.y + normal * n.z, normal);
}

// Of the side that `direction` comes to. A shading normal that faces away from the viewer describes no
// surface that can be seen: the geometric one stands in.
inline vec3 shading_normal(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                           uvec3 corners, vec2 b, vec3 face, vec3 direction) {
    vec3 normal = face;
    if ((mesh.arrays & MeshNormals) != 0u) {
        const vec3 mean = mesh.normals.items[corners.x] * (1.0f - b.x - b.y) +
                          mesh.normals.items[corners.y] * b.x + mesh.normals.items[corners.z] * b.y;
        normal = direction_of(instance.normals * mean, face);
    }
    normal = mapped_normal(scene, instance, mesh, material, corners, b, normal);
    const bool front = dot(face, direction) < 0.0f;
    if (!front) normal = -normal;
    if (dot(normal, direction) < 0.0f) return normal;
    return front ? face : -face;
}

// Directions by the shading normal where they leave the surface on their own sides, else by the geometric
// one: no light may get lost at the rim of a smooth body. Total reflection has to be that of both normals, or
// light would run around inside of a smooth body for ever, which no light from outside can do.
inline Specular specular_at(IN(Surface) surface, IN(Mixture) mixture, float eta, vec3 direction) {
    mat3 frame = surface.frame;
    Specular specular = make_specular(surface.albedo, mixture, eta, -direction * frame);
    const vec3 up = surface.geometric_normal * frame;
    bool consistent = dot(specular.reflected, up) > 0.0f;
    if (largest(specular.refraction) > 0.0f) {
        consistent = consistent && dot(specular.refracted, up) < 0.0f;
    } else if (mixture.glass > 0.0f) {
        consistent = consistent && fresnel_dielectric(-dot(direction, surface.geometric_normal), eta) == 1.0f;
    }
    if (!consistent) {
        frame = frame_around(surface.geometric_normal);
        specular = make_specular(surface.albedo, mixture, eta, -direction * frame);
    }
    specular.reflected = unit_vector(frame * specular.reflected);
    specular.refracted = frame * specular.refracted;
    return specular;
}

inline void set_scattering(INOUT(Surface) surface, IN(Scene) scene, IN(Mesh) mesh, IN(Material) material,
                           uvec3 corners, vec2 b, vec3 direction, bool front) {
    float metallic = material.metallic;
    float roughness = material.roughness;
    if (is_used(scene, material.metallic_roughness_texture) && (mesh.arrays & MeshTexCoords) != 0u) {
        const vec4 texel =
            lookup_use(scene, material.metallic_roughness_texture, tex_coord_at(mesh, corners, b));
        roughness *= texel.y;
        metallic *= texel.z;
    }
    const float cos_out = -dot(direction, surface.frame[2]);
    const Mixture mixture = make_mixture(metallic, roughness, material.transmission);
    surface.bsdf = make_bsdf(surface.albedo, mixture, roughness, material.index_of_refraction, cos_out);
    if ((scene.features & FeatureSpecular) != 0u && surface.scatters &&
        (mixture.mirror > 0.0f || mixture.glass > 0.0f)) {
        surface.rough_share = rough_share(mixture);
        // Bodies are solid: behind the front is glass, behind the back is air. Index 0 stands for infinity.
        const float n = material.index_of_refraction;
        surface.specular = specular_at(surface, mixture, front || n == 0.0f ? n : 1.0f / n, direction);
    }
}

inline Surface surface_of(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                          IN(Hit) hit, vec3 direction) {
    Surface surface;
    const uvec3 corners = mesh.triangles.items[hit.triangle];
    const vec2 b = hit.barycentric;
    const Triangle triangle = triangle_of(mesh, corners);
    const PointWithError point = point_on(instance, triangle, b);
    surface.position = point.position;
    surface.error = point.error;
    surface.object = instance.object;
    surface.triangle = hit.triangle;
    surface.light = instance.light;
    const vec3 face = face_normal(instance, triangle, vec3(0.0f, 0.0f, 1.0f));
    const bool front = dot(face, direction) < 0.0f;
    surface.geometric_normal = front ? face : -face;
    surface.frame =
        frame_around(shading_normal(scene, instance, mesh, material, corners, b, face, direction));

    const vec3 color = vec3(base_color_at(scene, material, mesh, corners, b));
    surface.albedo = clamp(color, 0.0f, 1.0f);  // vertex colours may say more than 1: no surface does
    surface.scatters = material.unlit == 0u;
    surface.emission = vec3(0.0f);
    if (!surface.scatters) {
        surface.emission = color;
    } else if (emits(material) && (front || material.double_sided != 0u)) {
        surface.emission = emission_at(scene, material, mesh, corners, b);
    }
    surface.rough_share = 1.0f;
    surface.specular = Specular(vec3(0.0f), vec3(0.0f), vec3(0.0f), vec3(0.0f));
    set_scattering(surface, scene, mesh, material, corners, b, direction, front);
    return surface;
}

inline Surface surface_on(IN(Scene) scene, IN(Instance) instance, IN(Hit) hit, vec3 direction) {
    return surface_of(scene, instance, scene.meshes.items[instance.mesh],
                      scene.materials.items[instance.material], hit, direction);
}

// `direction`: of the ray that hit, unit length.
inline Surface make_surface(IN(Scene) scene, IN(Hit) hit, vec3 direction) {
    return surface_on(scene, scene.instances.items[hit.instance], hit, direction);
}

SHADING_END

#endif

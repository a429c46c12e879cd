#ifndef TESSERA_MEDIATOR_SHADING_SURFACES_H
#define TESSERA_MEDIATOR_SHADING_SURFACES_H

#include "mediator/shading/containing_media.h"
#include "mediator/shading/motion.h"
#include "mediator/shading/perfect_specular.h"
#include "mediator/shading/ray_cones.h"
#include "mediator/shading/shading_normals.h"
#include "mediator/shading/surface_shader_eval.h"
#include "mediator/shading/triangle_points.h"

SHADING_BEGIN

// A shading point: what a path needs to know of its current vertex.
struct Surface {
    vec3 position;  // on the smooth surface that the mesh stands for, `lift` above the triangle
    vec3 error;     // bound of the position's rounding error, per axis
    vec3 lift;
    bool is_lifted;         // has such a lift: directions count as by the shading normal alone
    vec3 geometric_normal;  // unit length, on the side that the path came from
    mat3 frame;             // shading frame, third axis = shading normal, same side
    vec3 albedo;
    vec3 emission;
    Bsdf bsdf;             // without perfect speculars
    Specular specular;     // perfect mirror, smooth coat and smooth glass; directions in the world
    float rough_fraction;  // fraction of the material without perfect speculars
    uint object;           // id
    uint triangle;
    int light;        // index, if it is one
    float time;       // of the path
    int environment;  // index of the surface shader whose environment perfect speculars see; -1 = none
    bool scatters;
    bool is_thin_wall;  // its refraction, if any, leads straight on
    uint medium;        // instance of the medium that it bounds; NoInstance = none
    bool enters;        // whether a ray that passes through enters the medium
};

// The containing media of a ray that leaves the surface in this direction.
inline uvec4 media_after(IN(Scene) scene, uvec4 containing_media, IN(Surface) surface, vec3 direction) {
    if ((scene.features & FeatureMedia) == 0u || surface.medium == NoInstance) return containing_media;
    if (!(dot(direction, surface.geometric_normal) < 0.0f)) return containing_media;
    return after_crossing(scene, containing_media, surface.medium, surface.enters);
}

inline vec3 to_local(IN(Surface) surface, vec3 world) {
    return world * surface.frame;
}
inline vec3 to_world(IN(Surface) surface, vec3 local) {
    return surface.frame * local;
}

// The shading normal after the normal map.
inline vec3 mapped_normal(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(TextureUse) map,
                          float scale, uvec3 corners, vec2 b, vec3 normal) {
    if ((scene.features & FeatureNormalMaps) == 0u || !is_used(scene, map)) return normal;
    const vec4 tangent4 = tangent_at(instance, mesh, corners, b, normal);
    if (tangent4.w == 0.0f || (mesh.arrays & (MeshTexCoords | MeshTexCoords1)) == 0u) return normal;
    const vec3 tangent = vec3(tangent4);
    const vec3 bitangent = cross(normal, tangent) * tangent4.w;
    const vec3 texel = vec3(texel_of(scene, map, mesh, corners, b, 0.0f));
    vec3 n = 2.0f * texel - 1.0f;
    n.x *= scale;
    n.y *= scale;
    return direction_of(tangent * n.x + bitangent * n.y + normal * n.z, normal);
}

inline vec3 shading_normal(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                           IN(Triangle) t, uvec3 corners, vec2 b, vec3 face, vec3 direction) {
    if (has_surface_shader(scene, material)) {
        const vec3 bumped = shader_normal(
            scene, instance, scene.surface_shaders.items[material.surface_shader], material.normal_texture, t,
            mesh, corners, b, vertex_normal(instance, mesh, corners, b, face));
        return seen_normal(bumped, face, direction);
    }
    const vec3 normal = mapped_normal(scene, instance, mesh, material.normal_texture, material.normal_scale,
                                      corners, b, vertex_normal(instance, mesh, corners, b, face));
    return seen_normal(normal, face, direction);
}

// Frame around the normal; x along the direction of anisotropy, if any.
inline mat3 shading_frame(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                          IN(Triangle) t, uvec3 corners, vec2 b, vec3 normal) {
    if (has_surface_shader(scene, material)) {
        const SurfaceShaderParams shader = scene.surface_shaders.items[material.surface_shader];
        if (shader.shininess.x == shader.shininess.y) return frame_around(normal);
        const vec3 x = shader_frame(instance, shader, edges_in_world(instance, t), mesh,
                                    material.normal_texture.set, corners, b, normal)[0];
        return mat3(x, cross(normal, x), normal);
    }
    if (!has_extras(scene, material)) return frame_around(normal);
    CONST_REF(MaterialExtras) extras = scene.extras.items[material.extras];
    if (!(extras.anisotropy > 0.0f)) return frame_around(normal);
    const vec4 tangent4 = tangent_at(instance, mesh, corners, b, normal);
    if (tangent4.w == 0.0f) return frame_around(normal);
    const vec3 turn = anisotropy_at(scene, extras, mesh, corners, b);
    const vec3 tangent = vec3(tangent4);
    const vec3 x = direction_of(tangent * turn.x + cross(normal, tangent) * (tangent4.w * turn.y), tangent);
    return mat3(x, cross(normal, x), normal);
}

// Directions by the shading normal, turned where the mirrored ray would enter the face; by the geometric normal where
// the refracted one would not. No light may get lost at the silhouette of a smooth object. Total reflection must hold
// for both normals, otherwise light could be trapped inside of a smooth object, which light from outside cannot be.
inline Specular specular_at(IN(Surface) surface, IN(Mixture) mixture, IN(RoughGlass) glass, vec3 direction) {
    const vec3 normal = mirroring_normal(surface.frame[2], surface.geometric_normal, direction);
    mat3 frame = surface.frame;
    if (normal != surface.frame[2]) frame = frame_around(normal);
    Specular specular = make_specular(mixture, glass, -direction * frame);
    const vec3 up = surface.geometric_normal * frame;
    bool consistent = dot(specular.reflected, up) > 0.0f;
    if (largest(specular.refraction) > 0.0f) {
        consistent = consistent && dot(specular.refracted, up) < 0.0f;
    } else if (mixture.glass > 0.0f) {
        consistent =
            consistent && fresnel_dielectric(-dot(direction, surface.geometric_normal), glass.eta) == 1.0f;
    }
    if (!consistent) {
        frame = frame_around(surface.geometric_normal);
        specular = make_specular(mixture, glass, -direction * frame);
    }
    specular.reflected = unit_vector(frame * specular.reflected);
    specular.refracted = frame * specular.refracted;
    return specular;
}

// A smooth coat is an additional perfect mirror with its own normal, unless the base or glass is a perfect
// specular as well: then they share one direction.
inline void add_smooth_coat(INOUT(Surface) surface, IN(MaterialSample) material_sample, bool shares_direction,
                            vec3 direction) {
    vec3 normal = surface.frame * material_sample.coat_normal;
    if (!shares_direction) {
        normal = mirroring_normal(normal, surface.geometric_normal, direction);
        surface.specular.reflected = unit_vector(direction - 2.0f * dot(direction, normal) * normal);
    }
    const float fresnel = CoatF0 + (1.0f - CoatF0) * schlick_weight(abs(dot(direction, normal)));
    surface.specular.reflection += vec3(material_sample.coat * fresnel * surface.bsdf.sheen_out);
}

inline void set_specular(INOUT(Surface) surface, IN(MaterialSample) material_sample, IN(Mixture) mixture,
                         vec3 direction) {
    // A smooth face over the diffuse base.
    const bool smooth_face = mixture.dielectric > 0.0f && has_smooth_facets(material_sample) &&
                             (surface.bsdf.f90 > 0.0f || largest(surface.bsdf.f0) > 0.0f ||
                              (surface.bsdf.lobes & FeatureIridescence) != 0u);
    const bool perfect = mixture.mirror > 0.0f || mixture.glass > 0.0f || smooth_face;
    const bool smooth_coat =
        (material_sample.lobes & FeatureCoat) != 0u && is_smooth(surface.bsdf.coat_alpha);
    if (!perfect && !smooth_coat) return;
    surface.rough_fraction = rough_fraction(mixture);
    if (perfect) {
        const float passes = surface.bsdf.coat_out * surface.bsdf.sheen_out;
        surface.specular = specular_at(surface, mixture, surface.bsdf.glass, direction);
        if (smooth_face) {
            // Of half the angle between both directions.
            const float cosine =
                sqrt(clamp(0.5f - 0.5f * dot(direction, surface.specular.reflected), 0.0f, 1.0f));
            const vec3 fresnel = specular_fresnel(surface.bsdf, cosine);
            surface.specular.reflection += fresnel;
            surface.rough_fraction = greater_of(surface.rough_fraction - luminance(fresnel), 0.0f);
        }
        surface.specular.reflection *= passes;
        surface.specular.refraction *= passes;
    }
    if (smooth_coat) {
        add_smooth_coat(surface, material_sample, perfect, direction);
        surface.rough_fraction *= surface.bsdf.coat_out;
    }
}

// By the normals of specular_at.
inline void set_shader_specular(INOUT(Surface) surface, IN(Scene) scene, IN(SurfaceShaderLobes) lobes,
                                vec3 direction) {
    const bool wanted = (scene.features & FeatureSpecular) != 0u && surface.scatters;
    if (!wanted || !is_perfect(lobes.perfect)) return;
    const vec3 up = surface.geometric_normal;
    Specular specular =
        perfect_specular(lobes.perfect, direction, mirroring_normal(surface.frame[2], up, direction));
    const float down = -dot(direction, up);
    const bool refracts = largest(specular.refraction) > 0.0f;
    const bool stays = refracts ? dot(specular.refracted, up) < 0.0f
                                : !(largest(lobes.perfect.transmission) > 0.0f) ||
                                      reflects_totally(down, lobes.perfect.eta.y);
    if (!stays || !(dot(specular.reflected, up) > 0.0f)) {
        specular = perfect_specular(lobes.perfect, direction, up);
    }
    surface.specular = specular;
    surface.rough_fraction = lesser_of(luminance(lobes.left), 0.99999994f);
}

// What the coat and the sheen let pass of the material's own light, which is below them
// (KHR_materials_clearcoat, KHR_materials_sheen), along a ray that arrives in `direction`. The same for light
// that a path hits and for light that is sampled.
inline float emission_transmittance(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh,
                                    IN(Material) material, IN(Triangle) t, uvec3 corners, vec2 b, vec3 face,
                                    vec3 direction) {
    if ((scene.features & (FeatureCoat | FeatureSheen)) == 0u || !has_extras(scene, material)) return 1.0f;
    CONST_REF(MaterialExtras) extras = scene.extras.items[material.extras];
    if (!(extras.coat > 0.0f || largest(extras.sheen_color) > 0.0f)) return 1.0f;
    vec4 texels[4];
    NO_UNROLL
    for (uint i = 0u; i < 4u; ++i)
        texels[i] = texel_or_white(scene, extras.textures[ExtrasCoat + i], mesh, corners, b);
    float passes = 1.0f;
    const float coat = extras.coat * texels[0].x;
    if (coat > 0.0f) {
        const vec3 mapped =
            mapped_normal(scene, instance, mesh, extras.coat_normal_texture, extras.coat_normal_scale,
                          corners, b, vertex_normal(instance, mesh, corners, b, face));
        const float cosine = abs(dot(seen_normal(mapped, face, direction), direction));
        passes *= coat_transmittance(scene.energy, coat, extras.coat_roughness * texels[1].y, cosine);
    }
    const vec3 sheen = extras.sheen_color * vec3(texels[2]);
    if (largest(sheen) > 0.0f) {
        const vec3 normal = shading_normal(scene, instance, mesh, material, t, corners, b, face, direction);
        passes *= sheen_transmittance(scene.energy, sheen, extras.sheen_roughness * texels[3].w,
                                      abs(dot(normal, direction)));
    }
    return passes;
}

inline void set_scattering(INOUT(Surface) surface, IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh,
                           IN(Material) material, uvec3 corners, vec2 b, vec3 face, vec3 direction,
                           uvec4 containing_media) {
    const bool front = dot(face, direction) < 0.0f;
    if (has_surface_shader(scene, material)) {
        const uint shader = uint(material.surface_shader);
        const SurfaceShaderLobes lobes = shader_lobes_at(scene, shader, mesh, corners, b, surface.albedo,
                                                         front, -dot(direction, surface.frame[2]));
        fill_shader_bsdf(surface.bsdf, lobes);
        set_shader_specular(surface, scene, lobes, direction);
        if (largest(scene.surface_shaders.items[shader].environment) > 0.0f)
            surface.environment = material.surface_shader;
        return;
    }
    float n = material.index_of_refraction;
    if ((scene.features & FeatureNestedGlass) != 0u && surface.medium != NoInstance && material.thin == 0u) {
        n = nested_index_of_refraction(scene, containing_media, surface.medium, surface.enters);
    }
    MaterialSample material_sample =
        evaluate_material(scene, material, mesh, corners, b, surface.albedo, front, n);
    if ((material_sample.lobes & FeatureCoat) != 0u) {
        CONST_REF(MaterialExtras) extras = scene.extras.items[material.extras];
        const vec3 mapped =
            mapped_normal(scene, instance, mesh, extras.coat_normal_texture, extras.coat_normal_scale,
                          corners, b, vertex_normal(instance, mesh, corners, b, face));
        material_sample.coat_normal = to_local(surface, seen_normal(mapped, face, direction));
    }
    const Mixture mixture = make_mixture(material_sample);
    fill_bsdf(surface.bsdf, scene.energy, material_sample, mixture, to_local(surface, -direction));
    if ((scene.features & FeatureSpecular) != 0u && surface.scatters) {
        set_specular(surface, material_sample, mixture, direction);
    }
}

// Rays through the surface start at the triangle, and lights are sampled on it: what transmits or emits has no lift.
inline void lift_surface(INOUT(Surface) surface, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                         IN(Triangle) t, uvec3 corners, vec2 b, bool front) {
    surface.lift = vec3(0.0f);
    surface.is_lifted = false;
    if ((mesh.arrays & MeshNormals) == 0u || !surface.scatters || surface.medium != NoInstance) return;
    if (material.surface_shader >= 0 || material.transmission > 0.0f || emits(material)) return;
    const vec3 n0 = corner_normal(mesh, corners.x), n1 = corner_normal(mesh, corners.y),
               n2 = corner_normal(mesh, corners.z);
    if (n0 == n1 && n1 == n2) return;  // flat
    const bool outwards = dot(n0 + n1 + n2, cross(t.q - t.p, t.r - t.p)) > 0.0f;
    const vec3 lift = instance.linear * smooth_lift(t, n0, n1, n2, b, outwards == front ? 1.0f : -1.0f);
    if (!(dot(lift, surface.geometric_normal) > 0.0f)) return;
    surface.lift = lift;
    surface.is_lifted = true;
    surface.position += lift;
    // Of this sum and of its inverse, and of the lift itself: 16 roundings.
    surface.error += rounding_bound(2.0f) * abs(surface.position) + rounding_bound(16.0f) * abs(lift);
}

inline Surface surface_of(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                          IN(Hit) hit, vec3 direction, float width, uvec4 containing_media) {
    Surface surface;
    const uvec3 corners = mesh.triangles.items[hit.triangle];
    const vec2 b = hit.barycentric;
    const Triangle triangle = triangle_of(mesh, corners);
    const PointWithError point = point_on(instance, triangle, b);
    surface.position = point.position;
    surface.error = point.error + motion_error(scene, instance, mesh, triangle, b, point.position);
    surface.object = instance.object;
    surface.triangle = hit.triangle;
    surface.light = instance.light;
    const vec3 face = face_normal(instance, triangle, vec3(0.0f, 0.0f, 1.0f));
    const bool front = dot(face, direction) < 0.0f;
    surface.geometric_normal = front ? face : -face;
    surface.medium = has_medium(scene, hit.instance) ? hit.instance : NoInstance;
    surface.enters = front;
    surface.frame =
        shading_frame(scene, instance, mesh, material, triangle, corners, b,
                      shading_normal(scene, instance, mesh, material, triangle, corners, b, face, direction));

    const float footprint =
        material.filters_color != 0u
            ? triangle_footprint(scene, instance, triangle, abs(dot(face, direction)), width)
            : 0.0f;
    const vec3 color = vec3(base_color_at(scene, material, mesh, corners, b, footprint));
    surface.albedo = clamp(color, 0.0f, 1.0f);  // vertex colours may exceed 1; albedos may not
    surface.scatters = material.unlit == 0u;
    lift_surface(surface, instance, mesh, material, triangle, corners, b, front);
    surface.emission = vec3(0.0f);
    if (!surface.scatters) {
        surface.emission = color;
    } else if (emits(material) && (front || material.double_sided != 0u)) {
        surface.emission =
            emission_at(scene, material, mesh, corners, b) *
            emission_transmittance(scene, instance, mesh, material, triangle, corners, b, face, direction);
    }
    surface.rough_fraction = 1.0f;
    surface.specular = no_specular();
    surface.environment = -1;
    set_scattering(surface, scene, instance, mesh, material, corners, b, face, direction, containing_media);
    surface.is_thin_wall = (scene.features & FeatureThinGlass) != 0u && (material.thin & ThinClear) != 0u;
    if (surface.is_thin_wall) surface.specular.refracted = direction;
    return surface;
}

inline Surface surface_on(IN(Scene) scene, IN(Instance) instance, IN(Hit) hit, vec3 direction, float width,
                          uvec4 containing_media, float time) {
    Instance moved;
    const bool still = is_static(scene, instance.motion);
    if (!still) moved = instance_in_motion(scene, instance, time);
    CONST_REF(Instance) here = still ? instance : moved;
    Surface surface =
        surface_of(scene, here, mesh_at(scene, scene.meshes.items[instance.mesh], time),
                   scene.materials.items[instance.material], hit, direction, width, containing_media);
    surface.time = time;
    return surface;
}

// A scattering point in a medium, marked by FeatureMedia among its lobes.
inline Surface scattering_place(vec3 position, vec3 direction, float anisotropy, uint object, float time) {
    Surface surface;
    surface.position = position;
    surface.error = vec3(0.0f);
    surface.lift = vec3(0.0f);
    surface.is_lifted = false;
    surface.geometric_normal = vec3(0.0f);
    surface.frame = frame_around(-direction);
    surface.albedo = vec3(1.0f);  // absorption is in the path's throughput
    surface.emission = vec3(0.0f);
    surface.bsdf.lobes = FeatureMedia;
    surface.bsdf.anisotropy = anisotropy;
    surface.bsdf.coat_out = 1.0f;
    surface.bsdf.sheen_out = 1.0f;
    surface.bsdf.reflectance = 1.0f;
    surface.specular = no_specular();
    surface.rough_fraction = 1.0f;
    surface.object = object;
    surface.triangle = 0u;
    surface.light = -1;
    surface.time = time;
    surface.environment = -1;
    surface.scatters = true;
    surface.is_thin_wall = false;
    surface.medium = NoInstance;
    surface.enters = false;
    return surface;
}

inline bool passes_straight(IN(Surface) surface) {
    return surface.is_thin_wall && largest(surface.specular.refraction) > 0.0f;
}

inline bool is_in_medium(IN(Surface) surface) {
    return (surface.bsdf.lobes & FeatureMedia) != 0u;
}

// Where a ray hits a medium boundary without a surface.
struct Boundary {
    vec3 position;
    vec3 error;
    vec3 normal;  // to the side the ray came from
    bool enters;
};

inline Boundary boundary_of(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Hit) hit,
                            vec3 direction) {
    const Triangle triangle = triangle_of(mesh, mesh.triangles.items[hit.triangle]);
    const PointWithError point = point_on(instance, triangle, hit.barycentric);
    const vec3 face = face_normal(instance, triangle, vec3(0.0f, 0.0f, 1.0f));
    const bool front = dot(face, direction) < 0.0f;
    const vec3 error =
        point.error + motion_error(scene, instance, mesh, triangle, hit.barycentric, point.position);
    return Boundary(point.position, error, front ? face : -face, front);
}

inline Boundary boundary_at(IN(Scene) scene, IN(Hit) hit, vec3 direction, float time) {
    const Instance instance = scene.instances.items[hit.instance];
    return boundary_of(scene, instance_at(scene, instance, time),
                       mesh_at(scene, scene.meshes.items[instance.mesh], time), hit, direction);
}

// Whether a ray passes through the hit as if there were no surface: a medium boundary without a surface, or
// with alpha that lets it pass here (alpha_stops).
inline bool passes_boundary(IN(Scene) scene, IN(Hit) hit, IN(Sampler) numbers) {
    if ((scene.features & FeatureIndexMatchedMedia) == 0u || !has_medium(scene, hit.instance)) return false;
    if (is_index_matched(scene, hit.instance)) return true;
    if ((scene.features & FeatureAlpha) == 0u) return false;
    return !alpha_stops(scene, scene.materials.items[scene.instances.items[hit.instance].material],
                        scene.meshes.items[scene.instances.items[hit.instance].mesh], hit.instance,
                        hit.triangle, hit.barycentric, numbers);
}

// `direction`: of the ray, unit length; `width`: of the path there (ray_cones.h); `containing_media`: the
// media that it comes through.
inline Surface make_surface(IN(Scene) scene, IN(Hit) hit, vec3 direction, float width, uvec4 containing_media,
                            float time) {
    return surface_on(scene, scene.instances.items[hit.instance], hit, direction, width, containing_media,
                      time);
}

SHADING_END

#endif

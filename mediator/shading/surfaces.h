#ifndef TESSERA_MEDIATOR_SHADING_SURFACES_H
#define TESSERA_MEDIATOR_SHADING_SURFACES_H

#include "mediator/shading/bodies.h"
#include "mediator/shading/cones.h"
#include "mediator/shading/motion.h"
#include "mediator/shading/points.h"
#include "mediator/shading/shader_looks.h"
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
    Specular specular;  // perfect mirror, smooth coat and smooth glass; directions in the world
    float rough_share;  // of the material that is no perfect specular
    uint object;        // id
    uint triangle;
    int light;        // index, if it is one
    float time;       // of the path
    int environment;  // of perfect speculars: index of the shader that has one; -1 = none
    bool scatters;
    uint body;    // instance of the body whose boundary it is; NoInstance = of none
    bool enters;  // it, whoever goes through
};

// The bodies that light goes on in, in this direction.
inline uvec4 inside_after(IN(Scene) scene, uvec4 inside, IN(Surface) surface, vec3 direction) {
    if ((scene.features & FeatureMedia) == 0u || surface.body == NoInstance) return inside;
    if (!(dot(direction, surface.geometric_normal) < 0.0f)) return inside;
    return crossed(scene, inside, surface.body, surface.enters);
}

inline vec3 to_local(IN(Surface) surface, vec3 world) {
    return world * surface.frame;
}
inline vec3 to_world(IN(Surface) surface, vec3 local) {
    return surface.frame * local;
}

// What a normal map makes of the vertices' normal.
inline vec3 mapped_normal(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(TextureUse) map,
                          float scale, uvec3 corners, vec2 b, float footprint, vec3 normal) {
    if ((scene.features & FeatureNormalMaps) == 0u || !is_used(scene, map)) return normal;
    const vec4 tangent4 = tangent_at(instance, mesh, corners, b, normal);
    if (tangent4.w == 0.0f || (mesh.arrays & (MeshTexCoords | MeshTexCoords1)) == 0u) return normal;
    const vec3 tangent = vec3(tangent4);
    const vec3 bitangent = cross(normal, tangent) * tangent4.w;
    const vec3 texel = vec3(texel_of(scene, map, mesh, corners, b, footprint));
    vec3 n = 2.0f * texel - 1.0f;
    n.x *= scale;
    n.y *= scale;
    return direction_of(tangent * n.x + bitangent * n.y + normal * n.z, normal);
}

// A normal of the front, on the side that `direction` comes to. One that faces away from the viewer describes
// no surface that can be seen: the geometric one stands in.
inline vec3 seen_normal(vec3 normal, vec3 face, vec3 direction) {
    const bool front = dot(face, direction) < 0.0f;
    const vec3 seen = front ? normal : -normal;
    if (dot(seen, direction) < 0.0f) return seen;
    return front ? face : -face;
}

inline vec3 shading_normal(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                           IN(Triangle) t, uvec3 corners, vec2 b, float footprint, vec3 face,
                           vec3 direction) {
    if (has_shader(scene, material)) {
        const vec3 bumped =
            shader_normal(scene, instance, scene.shaders.items[material.shader], material.normal_texture, t,
                          mesh, corners, b, footprint, vertex_normal(instance, mesh, corners, b, face));
        return seen_normal(bumped, face, direction);
    }
    const vec3 normal = mapped_normal(scene, instance, mesh, material.normal_texture, material.normal_scale,
                                      corners, b, footprint, vertex_normal(instance, mesh, corners, b, face));
    return seen_normal(normal, face, direction);
}

// Around the normal; x along the direction of anisotropy, where there is one.
inline mat3 shading_frame(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                          IN(Triangle) t, uvec3 corners, vec2 b, float footprint, vec3 normal) {
    if (has_shader(scene, material)) {
        const Shader shader = scene.shaders.items[material.shader];
        if (shader.shininess.x == shader.shininess.y) return frame_around(normal);
        const vec3 x = shader_frame(instance, shader, edges_in_world(instance, t), mesh,
                                    material.normal_texture.set, corners, b, normal)[0];
        return mat3(x, cross(normal, x), normal);
    }
    if (!has_extras(scene, material)) return frame_around(normal);
    const MaterialExtras extras = scene.extras.items[material.extras];
    if (!(extras.anisotropy > 0.0f)) return frame_around(normal);
    const vec4 tangent4 = tangent_at(instance, mesh, corners, b, normal);
    if (tangent4.w == 0.0f) return frame_around(normal);
    const vec3 turn = anisotropy_at(scene, extras, mesh, corners, b, footprint);
    const vec3 tangent = vec3(tangent4);
    const vec3 x = direction_of(tangent * turn.x + cross(normal, tangent) * (tangent4.w * turn.y), tangent);
    return mat3(x, cross(normal, x), normal);
}

// Directions by the shading normal where they leave the surface on their own sides, else by the geometric
// one: no light may get lost at the rim of a smooth body. Total reflection has to be that of both normals, or
// light would run around inside of a smooth body for ever, which no light from outside can do.
inline Specular specular_at(IN(Surface) surface, IN(Mixture) mixture, IN(RoughGlass) glass, vec3 direction) {
    mat3 frame = surface.frame;
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

// A smooth coat is one more perfect mirror: by its own normal, but where base or glass are perfect as well,
// which share one direction with it.
inline void add_smooth_coat(INOUT(Surface) surface, IN(Look) look, IN(Mixture) mixture, vec3 direction) {
    vec3 normal = surface.frame * look.coat_normal;
    const bool shared_way = mixture.mirror > 0.0f || mixture.glass > 0.0f;
    vec3 reflected = direction - 2.0f * dot(direction, normal) * normal;
    if (!shared_way && !(dot(reflected, surface.geometric_normal) > 0.0f)) {
        normal = surface.geometric_normal;
        reflected = direction - 2.0f * dot(direction, normal) * normal;
    }
    if (!shared_way) surface.specular.reflected = unit_vector(reflected);
    const float fresnel = CoatF0 + (1.0f - CoatF0) * schlick_weight(abs(dot(direction, normal)));
    surface.specular.reflection += vec3(look.coat * fresnel * surface.bsdf.sheen_out);
}

inline void set_specular(INOUT(Surface) surface, IN(Look) look, IN(Mixture) mixture, vec3 direction) {
    const bool perfect = mixture.mirror > 0.0f || mixture.glass > 0.0f;
    const bool smooth_coat = (look.lobes & FeatureCoat) != 0u && is_smooth(surface.bsdf.coat_alpha);
    if (!perfect && !smooth_coat) return;
    surface.rough_share = rough_share(mixture);
    if (perfect) {
        const float passes = surface.bsdf.coat_out * surface.bsdf.sheen_out;
        surface.specular = specular_at(surface, mixture, surface.bsdf.glass, direction);
        surface.specular.reflection *= passes;
        surface.specular.refraction *= passes;
    }
    if (smooth_coat) {
        add_smooth_coat(surface, look, mixture, direction);
        surface.rough_share *= surface.bsdf.coat_out;
    }
}

// By the shading normal or the geometric one, as specular_at.
inline void set_shader_specular(INOUT(Surface) surface, IN(Scene) scene, IN(ShaderLobes) lobes,
                                vec3 direction) {
    const bool wanted = (scene.features & FeatureSpecular) != 0u && surface.scatters;
    if (!wanted || !is_perfect(lobes.perfect)) return;
    const vec3 up = surface.geometric_normal;
    Specular specular = perfect_specular(lobes.perfect, direction, surface.frame[2]);
    const float down = -dot(direction, up);
    const bool refracts = largest(specular.refraction) > 0.0f;
    const bool stays = refracts ? dot(specular.refracted, up) < 0.0f
                                : !(largest(lobes.perfect.transmission) > 0.0f) ||
                                      reflects_totally(down, lobes.perfect.eta.y);
    if (!stays || !(dot(specular.reflected, up) > 0.0f)) {
        specular = perfect_specular(lobes.perfect, direction, up);
    }
    surface.specular = specular;
    surface.rough_share = lesser_of(luminance(lobes.left), 0.99999994f);
}

inline void set_scattering(INOUT(Surface) surface, IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh,
                           IN(Material) material, uvec3 corners, vec2 b, float footprint, vec3 face,
                           vec3 direction, uvec4 inside) {
    const bool front = dot(face, direction) < 0.0f;
    if (has_shader(scene, material)) {
        const uint shader = uint(material.shader);
        const ShaderLobes lobes = shader_lobes_at(scene, shader, mesh, corners, b, footprint, surface.albedo,
                                                  front, -dot(direction, surface.frame[2]));
        fill_shader_bsdf(surface.bsdf, lobes);
        set_shader_specular(surface, scene, lobes, direction);
        if (largest(scene.shaders.items[shader].environment) > 0.0f) surface.environment = material.shader;
        return;
    }
    float n = material.index_of_refraction;
    if ((scene.features & FeatureNestedGlass) != 0u && surface.body != NoInstance && material.thin == 0u) {
        n = nested_index(scene, inside, surface.body, surface.enters);
    }
    Look look = look_at(scene, material, mesh, corners, b, footprint, surface.albedo, front, n);
    if ((look.lobes & FeatureCoat) != 0u) {
        const MaterialExtras extras = scene.extras.items[material.extras];
        const vec3 mapped =
            mapped_normal(scene, instance, mesh, extras.coat_normal_texture, extras.coat_normal_scale,
                          corners, b, footprint, vertex_normal(instance, mesh, corners, b, face));
        look.coat_normal = to_local(surface, seen_normal(mapped, face, direction));
    }
    const Mixture mixture = make_mixture(look);
    fill_bsdf(surface.bsdf, scene.energy, look, mixture, to_local(surface, -direction));
    if ((scene.features & FeatureSpecular) != 0u && surface.scatters) {
        set_specular(surface, look, mixture, direction);
    }
}

inline Surface surface_of(IN(Scene) scene, IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                          IN(Hit) hit, vec3 direction, float width, uvec4 inside) {
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
    surface.body = has_body(scene, hit.instance) ? hit.instance : NoInstance;
    surface.enters = front;
    const float footprint = triangle_footprint(scene, instance, triangle, abs(dot(face, direction)), width);
    surface.frame = shading_frame(
        scene, instance, mesh, material, triangle, corners, b, footprint,
        shading_normal(scene, instance, mesh, material, triangle, corners, b, footprint, face, direction));

    const vec3 color = vec3(base_color_at(scene, material, mesh, corners, b, footprint));
    surface.albedo = clamp(color, 0.0f, 1.0f);  // vertex colours may say more than 1: no surface does
    surface.scatters = material.unlit == 0u;
    surface.emission = vec3(0.0f);
    if (!surface.scatters) {
        surface.emission = color;
    } else if (emits(material) && (front || material.double_sided != 0u)) {
        surface.emission = emission_at(scene, material, mesh, corners, b);
    }
    surface.rough_share = 1.0f;
    surface.specular = no_specular();
    surface.environment = -1;
    set_scattering(surface, scene, instance, mesh, material, corners, b, footprint, face, direction, inside);
    return surface;
}

inline Surface surface_on(IN(Scene) scene, IN(Instance) instance, IN(Hit) hit, vec3 direction, float width,
                          uvec4 inside, float time) {
    Instance moved;
    const bool still = stands_still(scene, instance.motion);
    if (!still) moved = moved_instance(scene, instance, time);
    KEPT(Instance) here = still ? instance : moved;
    Surface surface = surface_of(scene, here, mesh_at(scene, scene.meshes.items[instance.mesh], time),
                                 scene.materials.items[instance.material], hit, direction, width, inside);
    surface.time = time;
    return surface;
}

// A place in a medium that a path is scattered at; by the feature FeatureMedia among its lobes.
inline Surface scattering_place(vec3 position, vec3 direction, float anisotropy, uint object, float time) {
    Surface surface;
    surface.position = position;
    surface.error = vec3(0.0f);
    surface.geometric_normal = vec3(0.0f);
    surface.frame = frame_around(-direction);
    surface.albedo = vec3(1.0f);  // what is absorbed is the path's
    surface.emission = vec3(0.0f);
    surface.bsdf.lobes = FeatureMedia;
    surface.bsdf.anisotropy = anisotropy;
    surface.bsdf.coat_out = 1.0f;
    surface.bsdf.sheen_out = 1.0f;
    surface.bsdf.reflectance = 1.0f;
    surface.specular = no_specular();
    surface.rough_share = 1.0f;
    surface.object = object;
    surface.triangle = 0u;
    surface.light = -1;
    surface.time = time;
    surface.environment = -1;
    surface.scatters = true;
    surface.body = NoInstance;
    surface.enters = false;
    return surface;
}

inline bool is_in_medium(IN(Surface) surface) {
    return (surface.bsdf.lobes & FeatureMedia) != 0u;
}

// Where a ray meets the boundary of a body that has no surface.
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

// Whether a ray goes through what it hit as if there were no surface: a body's boundary that has none, or
// none at this place by its alpha (alpha_stops).
inline bool passes_boundary(IN(Scene) scene, IN(Hit) hit, uint seed) {
    if ((scene.features & FeatureOpenMedia) == 0u || !has_body(scene, hit.instance)) return false;
    if (is_open(scene, hit.instance)) return true;
    if ((scene.features & FeatureAlpha) == 0u) return false;
    return !alpha_stops(scene, scene.materials.items[scene.instances.items[hit.instance].material],
                        scene.meshes.items[scene.instances.items[hit.instance].mesh], hit.instance,
                        hit.triangle, hit.barycentric, seed);
}

// `direction`: of the ray that hit, unit length; `width`: of the path there (cones.h); `inside`: what bodies
// it comes through.
inline Surface make_surface(IN(Scene) scene, IN(Hit) hit, vec3 direction, float width, uvec4 inside,
                            float time) {
    return surface_on(scene, scene.instances.items[hit.instance], hit, direction, width, inside, time);
}

SHADING_END

#endif

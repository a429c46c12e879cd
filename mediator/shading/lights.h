#ifndef TESSERA_MEDIATOR_SHADING_LIGHTS_H
#define TESSERA_MEDIATOR_SHADING_LIGHTS_H

#include "mediator/shading/area_lights.h"
#include "mediator/shading/environment.h"
#include "mediator/shading/light_choice.h"
#include "mediator/shading/surfaces.h"
#include "mediator/shading/triangle_lights.h"

// Samples one light, and a point on it.
SHADING_BEGIN

// A sampled point of a light, as seen from a surface.
struct LightSample {
    vec3 radiance;   // that arrives if unoccluded; of a delta light divided by its squared distance
    vec3 intensity;  // of the light towards the surface, independent of the distance
    vec3 direction;  // to the light, unit length
    float pdf;       // per solid angle, choice of the light included; 0 = no light
    bool delta;      // cannot be hit by BSDF sampling: the pdf is of the choice alone
    bool distant;    // at infinity
    vec3 target;     // where a shadow ray ends, if not distant; offset from the light's surface
    int emitter;     // index, of the light tree's
    float chance;    // of the choice
};

inline LightSample no_light() {
    return LightSample(vec3(0.0f), vec3(0.0f), vec3(0.0f), 0.0f, false, false, vec3(0.0f), -1, 1.0f);
}

// glTF's falloff between the cones (KHR_lights_punctual).
inline float spot_falloff(IN(LightSource) light, vec3 to_light) {
    const float cosine_axis = -dot(light.direction, to_light);
    if (!(cosine_axis > light.cos_outer)) return 0.0f;
    if (cosine_axis >= light.cos_inner) return 1.0f;
    const float t = (cosine_axis - light.cos_outer) / (light.cos_inner - light.cos_outer);
    return t * t;
}

inline LightSample sample_point_light(IN(LightSource) light, IN(Surface) surface, float probability) {
    LightSample found = no_light();
    const vec3 offset = light.position - surface.position;
    const float distance2 = dot(offset, offset);
    if (!(distance2 > 0.0f)) return found;
    found.delta = true;
    found.direction = offset / sqrt(distance2);
    const float falloff = light.kind == LightSpot ? spot_falloff(light, found.direction) : 1.0f;
    found.radiance = light.intensity / distance2 * falloff;
    found.intensity = light.intensity * falloff;
    found.pdf = probability;
    found.target = light.position;
    return found;
}

inline LightSample sample_distant_light(float probability, vec3 direction, vec3 radiance) {
    LightSample found = no_light();
    found.direction = direction;
    found.radiance = radiance;
    found.intensity = radiance;
    found.pdf = probability;
    found.distant = true;
    return found;
}

// A shadow ray ends where the sphere begins, and from inside where it ends.
inline LightSample sample_sphere_light(IN(LightSource) light, IN(Surface) surface, float probability,
                                       vec2 u) {
    LightSample found = no_light();
    const SphereView seen = view_sphere(light, surface.position);
    found.direction = sample_cone(seen.axis, seen.one_minus_cos_half_angle, u);
    found.radiance = light.intensity;
    found.intensity = light.intensity;
    found.pdf = probability * cone_pdf(seen.one_minus_cos_half_angle);
    found.target = surface.position + sphere_distance(light, seen, found.direction) * found.direction;
    return found;
}

inline LightSample sample_quad_light(IN(Emitter) emitter, IN(LightSource) light, IN(Surface) surface,
                                     float probability, vec2 u) {
    LightSample found = no_light();
    const QuadView seen = view_quad(light, surface.position);
    const vec2 place = sample_quad(seen, light.half_size, u);
    found.target = light.position + place.x * light.edge_u + place.y * light.edge_v;
    const DirectionAndDistance to_light = direction_and_distance(found.target - surface.position);
    const float facing = -dot(light.direction, to_light.direction);
    if (!(facing > 0.0f)) return no_light();
    found.direction = to_light.direction;
    found.radiance = light.intensity;
    found.intensity = light.intensity;
    found.pdf = probability * quad_pdf(seen, emitter.inverse_root_area, to_light.distance, facing);
    return found;
}

inline float triangle_pdf(IN(TriangleView) seen, float inverse_root_area, float distance, float facing) {
    if (is_by_solid_angle(seen)) return 1.0f / seen.solid_angle;
    return area_pdf(inverse_root_area, distance, facing);
}

inline LightSample sample_mesh_light(IN(Scene) scene, IN(Emitter) emitter, float probability,
                                     IN(Instance) instance, IN(Mesh) mesh, IN(Material) material,
                                     IN(Surface) surface, vec2 u) {
    LightSample found = no_light();
    const uvec3 corners = mesh.triangles.items[emitter.triangle];
    const Triangle triangle = triangle_of(mesh, corners);
    const float inverse_root_area = inverse_root_area_of(scene, emitter, instance, triangle);
    const TriangleView seen = view_triangle(instance, triangle, inverse_root_area, surface.position);
    const vec2 b = sample_triangle_light(seen, u);
    const PointWithError point = point_on(instance, triangle, b);
    const vec3 offset = point.position - surface.position;
    const DirectionAndDistance to_light = direction_and_distance(offset);
    const vec3 normal = face_normal(instance, triangle, vec3(0.0f));
    const float facing = -dot(normal, to_light.direction);
    if (facing == 0.0f || (facing < 0.0f && material.double_sided == 0u)) return found;
    found.direction = to_light.direction;
    found.radiance = emission_at(scene, material, mesh, corners, b) *
                     emission_transmittance(scene, instance, mesh, material, triangle, corners, b, normal,
                                            to_light.direction);
    if ((scene.features & FeatureAlpha) != 0u && material.alpha_mode != AlphaOpaque) {
        // The probability with which rays stop here (stops_at).
        const float alpha = alpha_at(scene, material, mesh, corners, b);
        const float masked = alpha >= material.alpha_cutoff ? 1.0f : 0.0f;
        found.radiance *= material.alpha_mode == AlphaMask ? masked : clamp(alpha, 0.0f, 1.0f);
    }
    found.intensity = found.radiance;
    found.pdf = probability * triangle_pdf(seen, inverse_root_area, to_light.distance, abs(facing));
    // Offset by the point's own error and the rounding error of the shadow ray's segment.
    const vec3 error = point.error + motion_error(scene, instance, mesh, triangle, b, point.position) +
                       2.0f * 5.9604644775390625e-8f * abs(offset);
    found.target = leave_surface(point.position, error, normal, -found.direction);
    return found;
}

inline LightSample sample_instance_light(IN(Scene) scene, IN(Emitter) emitter, float probability,
                                         IN(Instance) instance, IN(Surface) surface, vec2 u) {
    Instance moved;
    const bool still = is_static(scene, instance.motion);
    if (!still) moved = instance_in_motion(scene, instance, surface.time);
    CONST_REF(Instance) here = still ? instance : moved;
    return sample_mesh_light(scene, emitter, probability, here,
                             mesh_at(scene, scene.meshes.items[instance.mesh], surface.time),
                             scene.materials.items[instance.material], surface, u);
}

inline LightSample sample_emitter(IN(Scene) scene, IN(Emitter) emitter, IN(LightSource) light,
                                  float probability, IN(Surface) surface, vec2 u) {
    if (light.kind == LightMesh) {
        if ((scene.features & FeatureMeshLights) == 0u) return no_light();
        return sample_instance_light(scene, emitter, probability, scene.instances.items[light.instance],
                                     surface, u);
    }
    if ((scene.features & FeatureAreaLights) != 0u) {
        if (light.kind == LightSphere) return sample_sphere_light(light, surface, probability, u);
        if (light.kind == LightQuad) return sample_quad_light(emitter, light, surface, probability, u);
    }
    return sample_point_light(light, surface, probability);
}

// By the tiles of the receiver's cell, or by the map.
inline vec3 sample_visible_sky(IN(Scene) scene, IN(View) view, uint index, vec2 u) {
    if (index == NoSkyCell) return sample_sky(scene, u);
    const SkyCell cell = view.sky_cells.items[index];
    if (u.x < cell.tile_chance) {
        const Choice tile = choose(view.sky_cdfs, cell.cdf, SkyTiles, u.y);
        return direction_in_tile(tile.index, vec2(lesser_of(u.x / cell.tile_chance, 0.99999994f), tile.rest));
    }
    const float rest = (u.x - cell.tile_chance) / (1.0f - cell.tile_chance);
    return sample_sky(scene, vec2(lesser_of(rest, 0.99999994f), u.y));
}

inline LightSample sample_distant(IN(Scene) scene, IN(View) view, IN(LightSource) light,
                                  IN(Receiver) receiver, float probability, vec2 u) {
    if (light.kind == LightEnvironment) {
        const vec3 direction = sample_visible_sky(scene, view, receiver.sky_cell, u);
        const Sky sky = sky_at(scene, direction);
        LightSample found = sample_distant_light(probability, direction, sky.radiance);
        found.pdf *= sky_cell_pdf(view, receiver.sky_cell, direction, sky.pdf);
        return found;
    }
    LightSample found = sample_distant_light(probability, -light.direction, light.intensity);
    found.delta = !((scene.features & FeatureSunDisks) != 0u && light.one_minus_cos_half_angle > 0.0f);
    if (found.delta) return found;
    found.direction = sample_cone(found.direction, light.one_minus_cos_half_angle, u);
    found.pdf *= cone_pdf(light.one_minus_cos_half_angle);
    return found;
}

// Transmissive surfaces receive light from both sides; points in media have no normal.
inline Receiver receiver_at(IN(View) view, uint sample_index, IN(Surface) surface) {
    const bool through = (surface.bsdf.lobes & FeatureRoughGlass) != 0u;
    const vec3 normal = surface.is_lifted ? surface.frame[2] : surface.geometric_normal;
    const vec3 facing = through ? vec3(0.0f) : normal;
    const uint cell =
        is_in_medium(surface) ? NoSkyCell : sky_cell_at(view, sample_index, surface.position, facing);
    return Receiver(surface.position, facing, vec3(0.0f), cell);
}

inline LightSample sample_chosen(IN(Scene) scene, uint layers, IN(Surface) surface, IN(Emitter) emitter,
                                 IN(LightSource) light, float probability, vec2 u) {
    if (!is_seen(scene, light, layers)) return no_light();
    LightSource moved;
    const bool still = is_static(scene, light.motion);
    if (!still) moved = light_in_motion(scene, light, surface.time);
    CONST_REF(LightSource) here = still ? light : moved;
    return sample_emitter(scene, emitter, here, probability, surface, u);
}

inline LightSample sample_tree(IN(Scene) scene, uint layers, IN(Surface) surface, IN(ChosenEmitter) chosen,
                               vec2 u) {
    const Emitter emitter = scene.emitters.items[chosen.index];
    LightSample found = sample_chosen(scene, layers, surface, emitter, scene.lights.items[emitter.light],
                                      chosen.probability, u);
    found.emitter = int(chosen.index);
    found.chance = chosen.probability;
    return found;
}

// An emitter in none of the view's layers contributes nothing; choosing it wastes the sample, since all views
// have the same tree. If hidden emitters have probability p, the variance grows by 1 / (1 - p). `given`: an
// emitter that has been chosen already, if any.
inline LightSample sample_light(IN(Scene) scene, IN(View) view, IN(Surface) surface, IN(Receiver) receiver,
                                IN(ChosenEmitter) given, vec2 choice, vec2 u) {
    ChosenEmitter emitter = given;
    if (!(given.probability > 0.0f)) {
        const ChosenLight chosen = choose_light(scene, view, receiver, choice.x);
        if (!(chosen.probability > 0.0f)) return no_light();
        if (chosen.index >= scene.tree_light_count)
            return sample_distant(scene, view,
                                  light_at(scene, scene.lights.items[chosen.index], surface.time), receiver,
                                  chosen.probability, u);
        emitter = choose_emitter(scene, receiver, vec2(chosen.rest, choice.y));
        emitter.probability *= chosen.probability;
    }
    return sample_tree(scene, view.layers, surface, emitter, u);
}

// Density with which a point of the triangle that was hit is sampled from a place, per solid angle.
inline float hit_triangle_pdf(IN(Scene) scene, IN(Emitter) emitter, IN(Surface) hit, vec3 from) {
    const Instance resting = scene.instances.items[scene.lights.items[hit.light].instance];
    const Instance instance = instance_at(scene, resting, hit.time);
    Mesh mesh = mesh_at(scene, scene.meshes.items[instance.mesh], hit.time);
    const Triangle triangle = triangle_of(mesh, mesh.triangles.items[hit.triangle]);
    const float inverse_root_area = inverse_root_area_of(scene, emitter, instance, triangle);
    const TriangleView seen = view_triangle(instance, triangle, inverse_root_area, from);
    const DirectionAndDistance to_light = direction_and_distance(hit.position - from);
    return triangle_pdf(seen, inverse_root_area, to_light.distance,
                        abs(dot(hit.geometric_normal, to_light.direction)));
}

// Density with which sample_light finds, for a receiver, the point of a mesh light that was hit.
inline float mesh_light_pdf(IN(Scene) scene, IN(View) view, IN(Surface) hit, IN(Receiver) receiver) {
    if ((scene.features & FeatureMeshLights) == 0u || hit.light < 0) return 0.0f;
    const Emitter emitter = scene.emitters.items[scene.lights.items[hit.light].first_emitter + hit.triangle];
    if (emitter.node == NoLightNode) return 0.0f;
    const float probability =
        tree_chance(scene, view, receiver) * leaf_probability(scene, emitter.node, receiver);
    return probability * hit_triangle_pdf(scene, emitter, hit, receiver.position);
}

// The same of a direction to the sky.
inline float sky_light_pdf(IN(Scene) scene, IN(View) view, IN(Sky) sky, vec3 direction,
                           IN(Receiver) receiver) {
    if (scene.environment_light < 0) return 0.0f;
    const float pdf = sky_cell_pdf(view, receiver.sky_cell, direction, sky.pdf);
    return distant_chance(scene, view, scene.lights.items[scene.environment_light], receiver) * pdf;
}

SHADING_END

#endif

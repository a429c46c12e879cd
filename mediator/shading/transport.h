#ifndef TESSERA_MEDIATOR_SHADING_TRANSPORT_H
#define TESSERA_MEDIATOR_SHADING_TRANSPORT_H

#include "mediator/shading/equiangular.h"
#include "mediator/shading/media.h"
#include "mediator/shading/paths.h"
#include "mediator/shading/thin_walls.h"

// The steps of a path from vertex to vertex, shared by all renderers. Next event estimation with one light
// sample per vertex, combined with BSDF sampling by the power heuristic (Veach 1997). At perfect speculars
// there is no light sampling, and light found by the BSDF sample has weight 1.
//
// The including file defines a Context. It has `scene` (Scene), `view` (View) and `time` (of the sample; all
// its rays are traced at that time, paths.h), and the functions
//   bool trace_closest(IN(Context) context, IN(Ray) ray, IN(Sampler) numbers, IN(Skip) skip, OUT(Hit) hit);
//       the closest hit that is not skipped; false if there is none. Distances are in
//       lengths of the direction.
//   bool trace_occluded(IN(Context) context, vec3 origin, vec3 segment, float far, IN(Sampler) numbers,
//                       OUT(ThinWalls) walls);
//       whether anything but a thin wall (is_thin_wall) is hit beyond NearestHit and before `far`, in
//       multiples of the segment's length; if not, the thin walls that are
// both of which call stops_at with these numbers for instances that are alpha_tested. GLSL: declared before this
// file is included. C++: found in the namespace of the context, as are the functions that log a path when one
// sample is replayed (probe); they do nothing in shaders.
//   log_camera(context, ray)                     the camera ray
//   log_hit(context, surface, throughput)        what it hits, and what it carries there
//   log_miss(context)                            it leaves the scene
//   log_emission(context, emission, direction)   the surface shines
//   log_light(context, direction, gathered)      a light is seen
//   log_specular(context, reflects, direction)   perfect reflection or refraction
//   log_receiver(context, receiver, ray)         light is sampled at a surface; the ray leaves it
SHADING_BEGIN

#ifndef __cplusplus
#define log_camera(context, ray)
#define log_hit(context, surface, throughput)
#define log_miss(context)
#define log_emission(context, emission, direction)
#define log_light(context, direction, gathered)
#define log_specular(context, reflects, direction)
#define log_receiver(context, receiver, ray)
#endif

// Probabilities of a surface's lobe groups, in proportion to the luminance they pass on. Sum 1, or all 0 for
// a black surface.
struct LobeChances {
    float reflection;
    float refraction;
    float rough;
};

inline LobeChances lobe_chances(IN(Surface) surface) {
    if (surface.rough_fraction == 1.0f) return LobeChances(0.0f, 0.0f, 1.0f);
    const float reflection = luminance(surface.specular.reflection);
    const float refraction = luminance(surface.specular.refraction);
    const float sum = reflection + refraction + surface.bsdf.reflectance;
    if (!(sum > 0.0f)) return LobeChances(0.0f, 0.0f, 0.0f);
    return LobeChances(reflection / sum, refraction / sum, surface.bsdf.reflectance / sum);
}

inline constexpr uint LobeNone = 0u, LobeRough = 1u, LobeReflection = 2u, LobeRefraction = 3u;

// A lobe group, and the remaining random numbers of this vertex, in [0, 1).
struct Lobe {
    uint kind;
    vec2 direction;
    float choice;
    float roulette;
};

// Whether a direction leads to the same side of the surface by both normals: up, or down where light goes
// through. On a smooth surface the shading normal decides alone.
inline bool is_consistent_side(IN(Surface) surface, vec3 direction, vec3 wi) {
    if (is_in_medium(surface)) return true;
    if (surface.is_lifted) return wi.z > 0.0f;
    const float side = dot(direction, surface.geometric_normal);
    if ((surface.bsdf.lobes & FeatureRoughGlass) != 0u && wi.z < 0.0f) return side < 0.0f;
    return side > 0.0f;
}

// What is reflected by a smooth surface leaves from above the triangle, all other rays from the triangle.
inline Ray leaving(IN(Surface) surface, vec3 direction) {
    if (surface.is_lifted) {
        const bool reflects = dot(direction, surface.frame[2]) > 0.0f;
        const vec3 place = reflects ? surface.position : surface.position - surface.lift;
        const vec3 side = reflects ? surface.geometric_normal : direction;
        return Ray(leave_surface(place, surface.error, surface.geometric_normal, side), direction);
    }
    return Ray(leave_surface(surface.position, surface.error, surface.geometric_normal, direction),
               direction);
}

// Which part of the value is the diffuse lobe's.
inline vec3 diffuse_fraction(IN(BsdfValue) bsdf) {
    return vec3(bsdf.value.x > 0.0f ? bsdf.diffuse.x / bsdf.value.x : 0.0f,
                bsdf.value.y > 0.0f ? bsdf.diffuse.y / bsdf.value.y : 0.0f,
                bsdf.value.z > 0.0f ? bsdf.diffuse.z / bsdf.value.z : 0.0f);
}

// The vertex that the BSDF sample left.
inline Receiver last_receiver(IN(Path) path) {
    return Receiver(path.last_position, path.last_normal, vec3(0.0f), path.last_sky_cell);
}

// MIS weight of light that was hit by the BSDF sample; `other`: the density of next event estimation.
inline float weight_by_chance(IN(View) view, IN(Path) path, float other) {
    if (!(path.bsdf_pdf > 0.0f)) return 1.0f;
    if (view.strategy == StrategyLightsOnly) return other > 0.0f ? 0.0f : 1.0f;
    return view.strategy == StrategyBsdfOnly ? 1.0f : power_heuristic(path.bsdf_pdf, other);
}

// The environment that perfect speculars of a CommonSurfaceShader see in addition to the sky (Schwenk 5.A.3):
// colour x map; the map has the background's projection.
WITH_CONTEXT inline void add_shader_environment(IN(Context) context, INOUT(Path) path, IN(Ray) ray) {
    if ((context.scene.features & FeatureSurfaceShader) == 0u || path.chain.environment < 0) return;
    const SurfaceShaderParams shader = context.scene.surface_shaders.items[path.chain.environment];
    vec3 radiance = shader.environment;
    if (is_used(context.scene, shader.environment_texture)) {
        const vec2 place = direction_to_uv(ray.direction, 0.0f);
        radiance *= vec3(lookup_use(context.scene, shader.environment_texture, place, 0.0f));
    }
    add_light(path.found, context.view, path.throughput * radiance, path.class_info);
}

WITH_CONTEXT inline void add_sky(IN(Context) context, INOUT(Path) path, IN(Ray) ray) {
    if (context.scene.environment.emits == 0u) return;
    const Sky sky = sky_at(context.scene, ray.direction);
    connect_light(path.found, context.view, path.probability * sky.radiance);
    float other = 0.0f;
    if (path.bsdf_pdf > 0.0f)
        other = sky_light_pdf(context.scene, context.view, sky, ray.direction, last_receiver(path));
    const float weight = weight_by_chance(context.view, path, other);
    add_light(path.found, context.view, path.throughput * sky.radiance * weight, path.class_info);
}

WITH_CONTEXT inline void add_emission(IN(Context) context, INOUT(Path) path, IN(Ray) ray,
                                      IN(Surface) surface) {
    if (!(largest(surface.emission) > 0.0f)) return;
    connect_light(path.found, context.view, path.probability * surface.emission);
    float other = 0.0f;
    if (path.bsdf_pdf > 0.0f)
        other = mesh_light_pdf(context.scene, context.view, surface, last_receiver(path));
    const float weight = weight_by_chance(context.view, path, other);
    add_light(path.found, context.view, path.throughput * surface.emission * weight, path.class_info);
    log_emission(context, surface.emission, ray.direction);
}

// A connection to a light through medium boundaries without a surface, and through thin walls, which attenuate
// it. Its shadow ray is traced segment by segment by the same loop as the path's rays (trace.h), so that what
// it passes is multiplied in the order of the ray.
struct Connection {
    bool is_open;
    vec3 light;      // that arrives, unless the ray is blocked
    vec3 intensity;  // of the light
    bool distant;    // at infinity; else at distance 1, and
    vec3 target;     // at this place
    PathClassInfo class_info;
    Sampler numbers;  // of the shadow ray
    Ray resume;       // the path's next ray, if `resumes`, and its containing media
    bool resumes;
    uvec4 containing_media;
};

inline Connection no_connection() {
    return Connection(false, vec3(0.0f), vec3(0.0f), false, vec3(0.0f), direct_class_info(), Sampler(0u, 0u),
                      Ray(vec3(0.0f), vec3(0.0f)), false, no_media());
}

WITH_CONTEXT inline void receive_light(IN(Context) context, INOUT(PathSample) found, vec3 light,
                                       vec3 intensity, IN(PathClassInfo) class_info, vec3 direction) {
    add_light(found, context.view, light, class_info);
    connect_light(found, context.view, intensity);
    log_light(context, direction, light);
}

// What arrives through the walls of light from this direction; in the order of the ray, as a connection computes it, so that
// both have the same rounding errors.
WITH_CONTEXT inline void pass_thin_walls(IN(Context) context, IN(ThinWalls) walls, vec3 direction,
                                         INOUT(vec3) light, INOUT(vec3) intensity) {
    const bool is_reversed = walls.count == 2u && walls.second.distance < walls.first.distance;
    for (uint i = 0u; i < walls.count; ++i) {
        CONST_REF(Hit) hit = (i == 0u) != is_reversed ? walls.first : walls.second;
        const Surface wall = make_surface(context.scene, hit, direction, 0.0f, no_media(), context.time);
        const vec3 passed = passes_straight(wall) ? wall.specular.refraction : vec3(0.0f);
        light *= passed;
        intensity *= passed;
    }
}

inline PathClassInfo class_of_light(IN(View) view, IN(Path) path, IN(BsdfValue) bsdf) {
    PathClassInfo info =
        PathClassInfo(path.class_info.scatter_count + 1u, false, path.class_info.diffuse_fraction);
    if (records(view, RecordsDiffuse) && path.class_info.scatter_count == 0u)
        info.diffuse_fraction = diffuse_fraction(bsdf);
    return info;
}

// Equiangular samples with a smaller weight than this are subject to Russian roulette.
inline constexpr float MinConnectionWeight = 0.125f;

// Next event estimation. `connection` is opened if the shadow ray may cross medium boundaries. `equiangular`:
// of a point in a medium. `roulette`: a uniform number.
WITH_CONTEXT inline void add_lights(IN(Context) context, INOUT(Path) path, IN(Surface) surface,
                                    IN(Receiver) receiver, vec3 wo, IN(EquiangularSample) equiangular,
                                    float roulette, INOUT(Connection) connection) {
    if (context.scene.light_count == 0u) return;
    const vec4 numbers = light_numbers(path);
    const vec2 choice = vec2(numbers), u = vec2(numbers.z, numbers.w);
    ChosenEmitter given = no_emitter();
    if (equiangular.is_equiangular) given = equiangular.chosen;
    const LightSample light = sample_light(context.scene, context.view, surface, receiver, given, choice, u);
    if (!(light.pdf > 0.0f) || !(largest(light.radiance) > 0.0f)) return;
    if (context.view.strategy == StrategyBsdfOnly && !light.delta) return;
    const vec3 wi = to_local(surface, light.direction);
    if (!is_consistent_side(surface, light.direction, wi)) return;
    const BsdfValue bsdf = evaluate_bsdf(context.scene.energy, surface.bsdf, wo, wi);
    if (!(largest(bsdf.value) > 0.0f)) return;
    const bool alone = light.delta || context.view.strategy == StrategyLightsOnly;
    float weight = 1.0f, density = light.pdf;
    if ((context.scene.features & FeatureScattering) != 0u && equiangular.is_active) {
        const EquiangularWeights weights =
            equiangular_weights(context.scene, context.view, equiangular, light, receiver);
        weight = weights.weight;
        if (equiangular.is_equiangular) {
            // The power heuristic uses the density from the path's own vertex.
            density *= weights.other_probability / light.chance;
            const float survival = weight / MinConnectionWeight;
            if (survival < 1.0f) {
                if (!(roulette < survival)) return;
                weight = MinConnectionWeight;
            }
        }
        if (!(weight > 0.0f)) return;
    }
    if (!alone) weight *= power_heuristic(density, bsdf.pdf);
    const vec3 origin = leaving(surface, light.direction).origin;
    bool is_open = (context.scene.features & FeatureIndexMatchedMedia) != 0u;
    const Sampler shadow_numbers = shadow_ray_numbers(path);
    const uvec4 containing_media =
        media_after(context.scene, path.containing_media, surface, light.direction);
    vec3 arriving = path.throughput * bsdf.value * light.radiance * (weight / light.pdf);
    vec3 intensity = equiangular.is_equiangular ? vec3(0.0f) : path.probability * light.intensity;
    // Shadow rays have directions of any length.
    const vec3 segment = light.distant ? light.direction : light.target - origin;
    if (!is_open) {
        const float far = light.distant ? infinity() : 1.0f;
        path.rays += 1u;
        ThinWalls walls = no_thin_walls();
        if (trace_occluded(context, origin, segment, far, shadow_numbers, walls)) return;
        if ((context.scene.features & FeatureThinGlass) != 0u && walls.count > 0u) {
            is_open = !KeepsThinWalls || walls.count > MaxThinWalls || containing_media.x != NoInstance;
            if (!is_open) pass_thin_walls(context, walls, light.direction, arriving, intensity);
            if (!(largest(arriving) > 0.0f)) return;
        }
    }
    const PathClassInfo class_info = class_of_light(context.view, path, bsdf);
    if (is_open) {
        // Holds the shadow ray until the path's next ray is known (start_connection).
        connection = Connection(true, arriving, intensity, light.distant, light.target, class_info,
                                shadow_numbers, Ray(origin, segment), false, containing_media);
        return;
    }
    if ((context.scene.features & FeatureMedia) != 0u && !light.distant) {
        const float length = vector_length(segment);
        arriving *=
            transmittance(context.scene, containing_media, origin, light.direction, length, context.time);
    }
    receive_light(context, path.found, arriving, intensity, class_info, light.direction);
}

// The rough lobes with probability 1: there are no others, or they are followed as separate branches.
inline Lobe rough_lobe(IN(Path) path) {
    const SampleSet numbers = set_at(path, ScatterSet);
    const vec2 u = second_pair(numbers);
    return Lobe(LobeRough, first_pair(numbers), u.x, u.y);
}

// Chooses and divides the throughput by the probability; LobeNone ends the path.
inline Lobe choose_lobe(INOUT(Path) path, IN(Surface) surface, IN(Lobe) rough) {
    Lobe lobe = rough;
    if (surface.rough_fraction == 1.0f) return lobe;
    const LobeChances chances = lobe_chances(surface);
    const float specular = chances.reflection + chances.refraction;
    float first = specular;
    float width = chances.rough;
    if (lobe.choice < chances.reflection) {
        lobe.kind = LobeReflection;
        first = 0.0f;
        width = chances.reflection;
    } else if (lobe.choice < specular || !(chances.rough > 0.0f)) {
        lobe.kind = LobeRefraction;
        first = chances.reflection;
        width = chances.refraction;
    }
    if (!(width > 0.0f)) return Lobe(LobeNone, vec2(0.0f), 0.0f, 0.0f);
    lobe.choice = clamp((lobe.choice - first) / width, 0.0f, 0.99999994f);
    path.throughput /= width;
    return lobe;
}

// Sets `direction` to the sampled direction; false: the path ends. The caller counts the vertex.
inline bool scatter(FloatArray energy, IN(View) view, INOUT(Path) path, IN(Surface) surface,
                    IN(Receiver) receiver, vec3 wo, IN(Lobe) lobe, INOUT(vec3) direction) {
    const vec3 wi = sample_bsdf(surface.bsdf, wo, lobe.choice, lobe.direction);
    const BsdfValue bsdf = evaluate_bsdf(energy, surface.bsdf, wo, wi);
    if (!(bsdf.pdf > 0.0f)) return false;
    direction = unit_vector(to_world(surface, wi));
    if (!is_consistent_side(surface, direction, wi)) return false;
    path.throughput *= bsdf.value / bsdf.pdf;
    path.bsdf_pdf = bsdf.pdf;
    path.last_position = receiver.position;
    path.last_normal = receiver.normal;
    path.last_sky_cell = receiver.sky_cell;
    path.cone.spread = greater_of(path.cone.spread, chosen_spread(bsdf.pdf, path.numbers.index));
    if (records(view, RecordsDiffuse) && path.class_info.scatter_count == 0u)
        path.class_info.diffuse_fraction = diffuse_fraction(bsdf);
    path.class_info.scatter_count += 1u;
    path.class_info.last_is_delta = false;
    path.chain.environment = -1;
    return true;
}

// Scatters by a perfect specular lobe; returns the next direction. Straight through a thin wall nothing
// changes for the path but its throughput: connections of its last vertex pass the wall as well, so light
// behind it is found by both.
WITH_CONTEXT inline vec3 scatter_specular(IN(Context) context, INOUT(Path) path, IN(Surface) surface,
                                          IN(Lobe) lobe, bool is_straight) {
    const bool reflects = lobe.kind == LobeReflection;
    Refraction next = Refraction(surface.specular.reflection, surface.specular.reflected);
    if (!reflects) {
        next = refraction_of(surface.specular, channel_of(path.numbers), path.chain.is_single_channel);
        path.chain.is_single_channel = path.chain.is_single_channel || surface.specular.splits;
    }
    path.chain.environment = surface.environment;
    path.throughput *= next.weight;
    log_specular(context, reflects, next.direction);
    path.walls += is_straight ? 1u : 0u;
    path.speculars += is_straight ? 0u : 1u;
    if (is_straight && path.bsdf_pdf > 0.0f) return next.direction;
    path.bsdf_pdf = 0.0f;
    if (path.class_info.scatter_count > 0u) path.class_info.scatter_count += 1u;
    path.class_info.last_is_delta = true;
    return next.direction;
}

SHADING_END

#endif

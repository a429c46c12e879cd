#ifndef TESSERA_MEDIATOR_SHADING_TRANSPORT_H
#define TESSERA_MEDIATOR_SHADING_TRANSPORT_H

#include "mediator/shading/equiangular.h"
#include "mediator/shading/media.h"
#include "mediator/shading/paths.h"

// The steps of a path from surface to surface, shared by all ways to render. Next-event estimation with one
// light sample per vertex, combined with BSDF sampling by the power heuristic (Veach 1997); none of both at
// perfect speculars: what is seen in them counts in full.
//
// A Context is the including side's: it has `scene` (Scene), `view` (View) and `time` (of the sample: all its
// rays are traced at that time, paths.h), and there are
//   bool trace_closest(IN(Context) context, IN(Ray) ray, uint seed, IN(Skip) skip, OUT(Hit) hit);
//       the closest hit that is not skipped; false where there is none. Distances are in
//       lengths of the direction.
//   bool trace_occluded(IN(Context) context, vec3 origin, vec3 segment, float far, uint seed);
//       whether anything lies beyond NearestHit, before the share `far` of the segment
// both of which ask stops_at where an instance is alpha_tested, with this seed. GLSL: declared before this
// file is included. C++: found in the namespace of the context, and so are those that tell the story of a
// path when one sample is replayed for people; a shader is silent.
//   tell_camera(context, ray)                     where it starts
//   tell_hit(context, surface, throughput)        what it hits, and what it carries there
//   tell_miss(context)                            it leaves the scene
//   tell_emission(context, emission, direction)   the surface shines
//   tell_light(context, direction, gathered)      a light is seen
//   tell_specular(context, reflects, direction)   it goes on, reflected or refracted
SHADING_BEGIN

#ifndef __cplusplus
#define tell_camera(context, ray)
#define tell_hit(context, surface, throughput)
#define tell_miss(context)
#define tell_emission(context, emission, direction)
#define tell_light(context, direction, gathered)
#define tell_specular(context, reflects, direction)
#endif

// Probabilities of a surface's lobe groups, in proportion to the luminance they pass on. Sum 1, or all 0 for
// a black surface.
struct LobeChances {
    float reflection;
    float refraction;
    float rough;
};

inline LobeChances lobe_chances(IN(Surface) surface) {
    if (surface.rough_share == 1.0f) return LobeChances(0.0f, 0.0f, 1.0f);
    const float reflection = luminance(surface.specular.reflection);
    const float refraction = luminance(surface.specular.refraction);
    const float sum = reflection + refraction + surface.bsdf.reflectance;
    if (!(sum > 0.0f)) return LobeChances(0.0f, 0.0f, 0.0f);
    return LobeChances(reflection / sum, refraction / sum, surface.bsdf.reflectance / sum);
}

inline constexpr uint LobeNone = 0u, LobeRough = 1u, LobeReflection = 2u, LobeRefraction = 3u;

// One of the groups and the random numbers of this vertex that are left, in [0, 1).
struct Lobe {
    uint kind;
    float choice;
    float roulette;
};

// Whether a direction leads to the same side of the surface by both normals: up, or down where light goes
// through.
inline bool leads_on(IN(Surface) surface, vec3 direction, vec3 wi) {
    if (is_in_medium(surface)) return true;
    const float side = dot(direction, surface.geometric_normal);
    if ((surface.bsdf.lobes & FeatureRoughGlass) != 0u && wi.z < 0.0f) return side < 0.0f;
    return side > 0.0f;
}

inline Ray leaving(IN(Surface) surface, vec3 direction) {
    return Ray(leave_surface(surface.position, surface.error, surface.geometric_normal, direction),
               direction);
}

// Which part of the value is the diffuse lobe's.
inline vec3 diffuse_share(IN(BsdfValue) bsdf) {
    return vec3(bsdf.value.x > 0.0f ? bsdf.diffuse.x / bsdf.value.x : 0.0f,
                bsdf.value.y > 0.0f ? bsdf.diffuse.y / bsdf.value.y : 0.0f,
                bsdf.value.z > 0.0f ? bsdf.diffuse.z / bsdf.value.z : 0.0f);
}

// Weight of light that the path has come to by chance, when next-event estimation finds it with the density
// `other`.
inline float weight_by_chance(IN(View) view, IN(Path) path, float other) {
    if (!(path.bsdf_pdf > 0.0f)) return 1.0f;
    if (view.strategy == StrategyLightsOnly) return other > 0.0f ? 0.0f : 1.0f;
    return view.strategy == StrategyBsdfOnly ? 1.0f : power_heuristic(path.bsdf_pdf, other);
}

// What perfect speculars of CommonSurfaceShader see besides the sky (Schwenk 5.A.3): a map like that of the
// background, over the colour.
WITH_CONTEXT inline void add_own_environment(IN(Context) context, INOUT(Path) path, IN(Ray) ray) {
    if ((context.scene.features & FeatureShader) == 0u || path.chain.environment < 0) return;
    const Shader shader = context.scene.shaders.items[path.chain.environment];
    vec3 radiance = shader.environment;
    if (is_used(context.scene, shader.environment_texture)) {
        const vec2 place = direction_place(ray.direction, 0.0f);
        radiance *= vec3(lookup_use(context.scene, shader.environment_texture, place, 0.0f));
    }
    add_light(path.found, context.view, path.throughput * radiance, path.way);
}

WITH_CONTEXT inline void add_sky(IN(Context) context, INOUT(Path) path, IN(Ray) ray) {
    if (context.scene.environment.emits == 0u) return;
    const Sky sky = sky_at(context.scene, ray.direction);
    connect_light(path.found, context.view, path.probability * sky.radiance);
    const float weight = weight_by_chance(context.view, path, sky_light_pdf(context.scene, sky));
    add_light(path.found, context.view, path.throughput * sky.radiance * weight, path.way);
}

WITH_CONTEXT inline void add_emission(IN(Context) context, INOUT(Path) path, IN(Ray) ray,
                                      IN(Surface) surface) {
    if (!(largest(surface.emission) > 0.0f)) return;
    connect_light(path.found, context.view, path.probability * surface.emission);
    float other = 0.0f;
    if (path.bsdf_pdf > 0.0f)
        other = mesh_light_pdf(context.scene, surface,
                               Receiver(path.last_position, path.last_normal, vec3(0.0f)));
    const float weight = weight_by_chance(context.view, path, other);
    add_light(path.found, context.view, path.throughput * surface.emission * weight, path.way);
    tell_emission(context, surface.emission, ray.direction);
}

// Light that a path has asked for, while it is looked for through bodies that have no surface: with the path's
// own rays, one after the other (trace.h).
struct Connection {
    bool is_open;
    vec3 light;      // that arrives, unless something is on the way
    vec3 intensity;  // of the light
    bool distant;    // infinitely far; else its place is at distance 1
    Way way;
    uint seed;
    Ray resume;  // the path's next ray, if it has one, and what that goes through
    bool resumes;
    uvec4 inside;
};

inline Connection no_connection() {
    return Connection(false, vec3(0.0f), vec3(0.0f), false, direct_way(), 0u, Ray(vec3(0.0f), vec3(0.0f)),
                      false, nowhere());
}

WITH_CONTEXT inline void receive_light(IN(Context) context, INOUT(PathSample) found, vec3 light,
                                       vec3 intensity, IN(Way) way, vec3 direction) {
    add_light(found, context.view, light, way);
    connect_light(found, context.view, intensity);
    tell_light(context, direction, light);
}

// Light of a place aside that has a smaller share of what is found there is looked for less often.
inline constexpr float WorthAConnection = 0.125f;

// What is asked for and may arrive: `connection` is open where it has to be looked for. `leg`: of a place in
// a medium.
WITH_CONTEXT inline void add_lights(IN(Context) context, INOUT(Path) path, IN(Surface) surface, vec3 wo,
                                    IN(LegLight) leg, INOUT(Connection) connection) {
    if (context.scene.light_count == 0u) return;
    const vec2 choice = pair_at(path, PairLightChoice);
    const vec2 u = pair_at(path, PairLightPoint);
    ChosenEmitter given = no_emitter();
    if (leg.is_aside) given = leg.chosen;
    const LightSample light = sample_light(context.scene, context.view.layers, surface, given, choice, u);
    if (!(light.pdf > 0.0f) || !(largest(light.radiance) > 0.0f)) return;
    if (context.view.strategy == StrategyBsdfOnly && !light.delta) return;
    const vec3 wi = to_local(surface, light.direction);
    if (!leads_on(surface, light.direction, wi)) return;
    const BsdfValue bsdf = evaluate_bsdf(context.scene.energy, surface.bsdf, wo, wi);
    if (!(largest(bsdf.value) > 0.0f)) return;
    const bool alone = light.delta || context.view.strategy == StrategyLightsOnly;
    float weight = 1.0f, density = light.pdf;
    if ((context.scene.features & FeatureScattering) != 0u && leg.is_on) {
        const LegShares shares =
            leg_shares(context.scene, context.view.strategy, leg, light, receiver_at(surface));
        weight = shares.share;
        if (leg.is_aside) {
            // What the power heuristic compares is what is found from the path's own place.
            density *= shares.other_chance / light.chance;
            const float worth = weight / WorthAConnection;
            if (worth < 1.0f) {
                if (!(pair_at(path, PairLobeAndRoulette).y < worth)) return;
                weight = WorthAConnection;
            }
        }
        if (!(weight > 0.0f)) return;
    }
    if (!alone) weight *= power_heuristic(density, bsdf.pdf);
    const vec3 origin = leaving(surface, light.direction).origin;
    const bool is_open = (context.scene.features & FeatureOpenMedia) != 0u;
    const uint seed = shadow_seed(path);
    // Of a ray to a light alone the direction has any length.
    const vec3 segment = light.distant ? light.direction : light.target - origin;
    if (!is_open) {
        const float far = light.distant ? infinity() : 1.0f;
        path.rays += 1u;
        if (trace_occluded(context, origin, segment, far, seed)) return;
    }
    vec3 arriving = path.throughput * bsdf.value * light.radiance * (weight / light.pdf);
    const vec3 intensity = leg.is_aside ? vec3(0.0f) : path.probability * light.intensity;
    Way way = Way(path.way.scatterings + 1u, false, path.way.diffuse_share);
    if (keeps(context.view, KeepsDiffuse) && path.way.scatterings == 0u) {
        way.diffuse_share = diffuse_share(bsdf);
    }
    const uvec4 inside = inside_after(context.scene, path.inside, surface, light.direction);
    if (is_open) {
        // The ray is the light's until the path's own next is known (look_for_light).
        connection = Connection(true, arriving, intensity, light.distant, way, seed, Ray(origin, segment),
                                false, inside);
        return;
    }
    if ((context.scene.features & FeatureMedia) != 0u && !light.distant) {
        const float length = vector_length(segment);
        arriving *= transmittance(context.scene, inside, origin, light.direction, length, context.time);
    }
    receive_light(context, path.found, arriving, intensity, way, light.direction);
}

// The rough group for certain: all there is, or the others are followed on their own.
inline Lobe rough_lobe(IN(Path) path) {
    const vec2 u = pair_at(path, PairLobeAndRoulette);
    return Lobe(LobeRough, u.x, u.y);
}

// Chooses and divides the throughput by the probability; LobeNone ends the path.
inline Lobe choose_lobe(INOUT(Path) path, IN(Surface) surface, IN(Lobe) rough) {
    Lobe lobe = rough;
    if (surface.rough_share == 1.0f) return lobe;
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
    if (!(width > 0.0f)) return Lobe(LobeNone, 0.0f, 0.0f);
    lobe.choice = clamp((lobe.choice - first) / width, 0.0f, 0.99999994f);
    path.throughput /= width;
    return lobe;
}

// `direction` becomes the next one; false ends the path. The vertex is for the caller to count.
inline bool scatter(FloatArray energy, IN(View) view, INOUT(Path) path, IN(Surface) surface, vec3 wo,
                    IN(Lobe) lobe, INOUT(vec3) direction) {
    const vec2 u = pair_at(path, PairBsdfDirection);
    const vec3 wi = sample_bsdf(surface.bsdf, wo, lobe.choice, u);
    const BsdfValue bsdf = evaluate_bsdf(energy, surface.bsdf, wo, wi);
    if (!(bsdf.pdf > 0.0f)) return false;
    direction = unit_vector(to_world(surface, wi));
    if (!leads_on(surface, direction, wi)) return false;
    path.throughput *= bsdf.value / bsdf.pdf;
    path.bsdf_pdf = bsdf.pdf;
    const Receiver receiver = receiver_at(surface);
    path.last_position = receiver.position;
    path.last_normal = receiver.normal;
    path.cone.spread = greater_of(path.cone.spread, chosen_spread(bsdf.pdf, path.numbers.index));
    if (keeps(view, KeepsDiffuse) && path.way.scatterings == 0u) path.way.diffuse_share = diffuse_share(bsdf);
    path.way.scatterings += 1u;
    path.way.last_is_delta = false;
    path.chain.environment = -1;
    return true;
}

// By a perfect specular; returns the next direction.
WITH_CONTEXT inline vec3 pass_on(IN(Context) context, INOUT(Path) path, IN(Surface) surface, IN(Lobe) lobe) {
    const bool reflects = lobe.kind == LobeReflection;
    Refraction way = Refraction(surface.specular.reflection, surface.specular.reflected);
    if (!reflects) {
        way = refraction_of(surface.specular, channel_of(path.numbers), path.chain.has_one_channel);
        path.chain.has_one_channel = path.chain.has_one_channel || surface.specular.splits;
    }
    path.chain.environment = surface.environment;
    path.throughput *= way.share;
    path.bsdf_pdf = 0.0f;
    if (path.way.scatterings > 0u) path.way.scatterings += 1u;
    path.way.last_is_delta = true;
    tell_specular(context, reflects, way.direction);
    return way.direction;
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_MEDIA_H
#define TESSERA_MEDIATOR_SHADING_MEDIA_H

#include "mediator/shading/bodies.h"
#include "mediator/shading/volumes.h"

// What the medium does to light on a leg of a path, between two surfaces: dL/ds = -(a + s) L + e + s x what
// comes from elsewhere (Schwenk 5.B.3; e is not multiplied by a). Emission counts along the whole leg, whether
// the path is scattered on it or not. Where it is scattered is sampled by the extinction a + s of one channel,
// and weighed by the density of all of them (balance heuristic, Veach 1997), each in proportion to what the path
// carries: what is left of grey light is what there was of it.
//
// In a textured body extinction is summed from cell to cell of the textures' lattices, each by two points of
// Gauss, which are exact for the cubics there; places are sampled as if extinction were the cell's mean, and
// weighed by what it is.
SHADING_BEGIN

inline constexpr uint LegPasses = 0u;      // it is asked what comes through
inline constexpr uint LegMayScatter = 1u;  // the path is scattered on the way or not
inline constexpr uint LegScatters = 2u;    // it is scattered, and what comes through is asked for as well

struct LegQuestion {
    uint kind;
    vec3 weights;  // of the channels; sum 1
    uint channel;  // chosen by them
    vec2 u;        // how far; the second are further digits of the first
    float place;   // where emission is looked up
    float aside;   // a place that is asked for besides (equiangular.h), in metres; less than 0: none
};

struct Leg {
    vec3 passed;     // share of the light from its end
    vec3 emitted;    // radiance on the way
    vec3 scattered;  // share of the light from the place where the path is scattered, divided by its density
    float distance;  // of that place
    bool scatters;
    float anisotropy;
    float density;        // per metre, with which it is scattered there
    vec3 aside;           // share of the light from the other place that is asked for, per metre
    float aside_density;  // with which the path is scattered there
};

inline Leg clear_leg() {
    return Leg(vec3(1.0f), vec3(0.0f), vec3(0.0f), 0.0f, false, 0.0f, 0.0f, vec3(0.0f), 0.0f);
}

inline float channel_value(vec3 v, uint channel) {
    return channel == 0u ? v.x : (channel == 1u ? v.y : v.z);
}

inline vec3 exponentials(vec3 x) {
    return vec3(exponential(x.x), exponential(x.y), exponential(x.z));
}

// 1 - exp(-x) for x >= 0, relative error below 2^-21.
inline float absorbed_share(float x) {
    if (x > 0.25f) return 1.0f - exponential(-x);
    const float p = 1.0f - x * (1.0f / 6.0f) * (1.0f - x * (1.0f / 7.0f));
    return x * (1.0f - 0.5f * x * (1.0f - x * (1.0f / 3.0f) * (1.0f - 0.25f * x * (1.0f - 0.2f * x * p))));
}

// -log(1 - v) for v in [0, 1): the optical depth at which a share v is gone. By the area tangent where it is
// small.
inline float depth_of_share(float v) {
    if (v > 0.25f) return -logarithm(1.0f - v);
    const float s = v / (2.0f - v), s2 = s * s;
    return 2.0f * s * (1.0f + s2 * (1.0f / 3.0f + s2 * (0.2f + s2 * (1.0f / 7.0f))));
}

// Below this optical depth of the leg, a place to scatter at is chosen evenly.
inline constexpr float ThinLeg = 1.0f / 4096.0f;

// The optical depth at which a path is scattered, of `whole` on the leg.
inline float scattering_depth(uint kind, vec2 u, float whole) {
    if (kind == LegMayScatter) {
        return depth_of_share(lesser_of(u.x + u.y * 5.9604644775390625e-8f, 0.99999994f));
    }
    if (whole < ThinLeg) return u.x * whole;
    return lesser_of(depth_of_share(lesser_of(u.x * absorbed_share(whole), 0.99999994f)), whole);
}

// Its density, per optical depth.
inline float scattering_density(uint kind, float depth, float whole) {
    if (kind == LegMayScatter) return exponential(-depth);
    if (whole < ThinLeg) return whole > 0.0f ? 1.0f / whole : 0.0f;
    return exponential(-depth) / absorbed_share(whole);
}

// Per metre, of all channels together, each by its own rate.
inline float scattering_densities(IN(LegQuestion) question, vec3 rate, vec3 depth, vec3 whole) {
    return question.weights.x * rate.x * scattering_density(question.kind, depth.x, whole.x) +
           question.weights.y * rate.y * scattering_density(question.kind, depth.y, whole.y) +
           question.weights.z * rate.z * scattering_density(question.kind, depth.z, whole.z);
}

// What comes through, divided by the probability with which the path does.
inline vec3 passed_share(IN(LegQuestion) question, vec3 whole) {
    const vec3 passed = exponentials(-whole);
    if (question.kind != LegMayScatter) return passed;
    const float probability = dot(question.weights, passed);
    return probability > 0.0f ? passed / probability : vec3(0.0f);
}

inline vec3 scattered_share(vec3 scattering, vec3 depth, float density) {
    return density > 0.0f ? scattering * exponentials(-depth) / density : vec3(0.0f);
}

// Share of what is emitted evenly along an optical depth that comes out.
inline float emitted_share(float depth) {
    return depth > 0.0f ? absorbed_share(depth) / depth : 1.0f;
}

inline Leg leg_through_even(IN(Body) body, float length, IN(LegQuestion) question) {
    Leg leg = clear_leg();
    const vec3 extinction = body.absorption + body.scattering;
    const vec3 whole = extinction * length;
    leg.emitted =
        body.emission * length * vec3(emitted_share(whole.x), emitted_share(whole.y), emitted_share(whole.z));
    leg.passed = passed_share(question, whole);
    if (question.kind == LegPasses) return leg;
    const float rate = channel_value(extinction, question.channel);
    const float all = channel_value(whole, question.channel);
    if (question.aside >= 0.0f) {
        const vec3 there = extinction * question.aside;
        leg.aside = body.scattering * exponentials(-there);
        leg.aside_density = scattering_densities(question, extinction, there, whole);
    }
    const float depth = scattering_depth(question.kind, question.u, all);
    if (!(depth < all)) return leg;
    leg.scatters = true;
    leg.distance = lesser_of(depth / rate, length);
    const vec3 depths = extinction * leg.distance;
    // Over the largest rate, so that products stay in range.
    const float most = largest(extinction), scale = 1.0f / most;
    const float density = scattering_densities(question, extinction * scale, depths, whole);
    leg.scattered = scattered_share(body.scattering * scale, depths, density);
    leg.density = density * most;
    return leg;
}

struct Coefficients {
    vec3 extinction;
    vec3 scattering;
};

inline vec3 body_texel(IN(Scene) scene, IN(Body) body, uint texture, vec3 at) {
    if (body.textures[texture].texture < 0) return vec3(1.0f);
    return lookup_volume(scene, scene.textures.items[body.textures[texture].texture],
                         volume_place(body.textures[texture], at));
}

inline Coefficients coefficients_at(IN(Scene) scene, IN(Body) body, IN(BoxRay) ray, float distance) {
    const vec3 at = ray.origin + distance * ray.direction;
    vec3 texels[2];
    KEEP_LOOP
    for (uint i = 0u; i < 2u; ++i) texels[i] = body_texel(scene, body, i, at);
    const vec3 scattering = body.scattering * texels[BodyScattering];
    return Coefficients(body.absorption * texels[BodyAbsorption] + scattering, scattering);
}

// Mean of the extinction over a part of a cell: two points of Gauss.
inline vec3 mean_extinction(IN(Scene) scene, IN(Body) body, IN(BoxRay) ray, float near, float far) {
    vec3 sum = vec3(0.0f);
    KEEP_LOOP
    for (uint i = 0u; i < 2u; ++i) {
        const float share = i == 0u ? 0.211324865f : 0.788675135f;
        sum += coefficients_at(scene, body, ray, near + share * (far - near)).extinction;
    }
    return 0.5f * sum;
}

// Of a cell: looked up at one place, chosen by how much of it comes out.
inline vec3 cell_emission(IN(Scene) scene, IN(Body) body, IN(BoxRay) ray, float near, float far, vec3 rate,
                          float choice) {
    const float grey_rate = (rate.x + rate.y + rate.z) * (1.0f / 3.0f);
    const float whole = grey_rate * (far - near);
    const bool thin = whole < ThinLeg;
    const float depth = scattering_depth(LegScatters, vec2(choice, 0.0f), whole);
    const float place = thin ? near + choice * (far - near) : near + depth / grey_rate;
    const float density =
        thin ? 1.0f / (far - near) : grey_rate * scattering_density(LegScatters, depth, whole);
    const vec3 passed = exponentials(-mean_extinction(scene, body, ray, near, place) * (place - near));
    const vec3 texel = body_texel(scene, body, BodyEmission, ray.origin + place * ray.direction);
    return body.emission * texel * passed / density;
}

// Cells of a leg; the last one reaches to its end, however finer the textures are.
inline constexpr uint MaxCells = 16384u;
inline constexpr float GoldenShare = 0.618033989f;

inline Leg leg_through_cells(IN(Scene) scene, IN(Body) body, IN(BoxRay) ray, float length,
                             IN(LegQuestion) question) {
    Leg leg = clear_leg();
    const bool emits = largest(body.emission) > 0.0f;
    vec3 whole = vec3(0.0f);  // of the leg, known from the first pass on
    // Two passes where the place depends on what the leg has in all.
    KEEP_LOOP
    for (uint pass = question.kind == LegScatters ? 0u : 1u; pass < 2u; ++pass) {
        float wanted = infinity();
        if (pass == 1u && question.kind != LegPasses) {
            wanted = scattering_depth(question.kind, question.u, channel_value(whole, question.channel));
        }
        vec3 depth = vec3(0.0f);
        float near = 0.0f;
        KEEP_LOOP
        for (uint cell = 1u; near < length && !(leg.scatters && !emits && near > question.aside); ++cell) {
            const float next = cell < MaxCells ? next_cell(scene, body, ray, near) : length;
            const float far = lesser_of(next, length);
            const vec3 rate = mean_extinction(scene, body, ray, near, far);
            if (pass == 1u && emits) {
                float choice = question.place + float(cell) * GoldenShare;
                choice -= floor(choice);
                leg.emitted +=
                    exponentials(-depth) * cell_emission(scene, body, ray, near, far, rate, choice);
            }
            const vec3 after = depth + rate * (far - near);
            const bool scatters_here =
                pass == 1u && !leg.scatters && channel_value(after, question.channel) > wanted;
            const bool is_asked =
                pass == 1u && question.aside >= near && (question.aside < far || !(far < length));
            KEEP_LOOP
            for (uint place = scatters_here ? 0u : 1u; place < (is_asked ? 2u : 1u); ++place) {
                const float rest = wanted - channel_value(depth, question.channel);
                const float part =
                    place == 1u ? lesser_of(question.aside, far) - near
                                : clamp(rest / channel_value(rate, question.channel), 0.0f, far - near);
                const vec3 there = depth + part * mean_extinction(scene, body, ray, near, near + part);
                const vec3 scattering = coefficients_at(scene, body, ray, near + part).scattering;
                const float density = scattering_densities(question, rate, depth + part * rate, whole);
                if (place == 1u) {
                    leg.aside = scattering * exponentials(-there);
                    leg.aside_density = density;
                } else {
                    leg.scatters = true;
                    leg.distance = near + part;
                    leg.scattered = scattered_share(scattering, there, density);
                    leg.density = density;
                }
            }
            depth = after;
            near = far;
        }
        if (!(near < length)) whole = depth;
    }
    leg.passed = passed_share(question, whole);
    return leg;
}

inline Leg leg_in_body(IN(Scene) scene, IN(Body) body, uint instance, vec3 origin, vec3 direction,
                       float length, IN(LegQuestion) asked, float time) {
    LegQuestion question = asked;
    const bool scatters = (scene.features & FeatureScattering) != 0u && largest(body.scattering) > 0.0f;
    if (!scatters) question.kind = LegPasses;
    if (question.kind == LegPasses) question.aside = -1.0f;
    if ((scene.features & FeatureMediaTextures) != 0u && body.textured != 0u) {
        const BoxRay ray =
            box_ray(instance_at(scene, scene.instances.items[instance], time), body, origin, direction);
        return leg_through_cells(scene, body, ray, length, question);
    }
    return leg_through_even(body, length, question);
}

// Of a way of this length (metres) through the bodies that it is in. Bodies are closed: one that a ray leaves
// the scene from ends with its last surface.
inline Leg leg_through(IN(Scene) scene, uvec4 inside, vec3 origin, vec3 direction, float length,
                       IN(LegQuestion) question, float time) {
    if ((scene.features & FeatureMedia) == 0u || inside.x == NoInstance || !is_finite(length)) {
        return clear_leg();
    }
    const int index = scene.instances.items[inside.x].body;
    Leg leg =
        leg_in_body(scene, scene.bodies.items[index], inside.x, origin, direction, length, question, time);
    leg.anisotropy = scene.bodies.items[index].anisotropy;
    return leg;
}

inline LegQuestion what_passes() {
    return LegQuestion(LegPasses, vec3(1.0f / 3.0f), 0u, vec2(0.0f), 0.0f, -1.0f);
}

inline vec3 transmittance(IN(Scene) scene, uvec4 inside, vec3 origin, vec3 direction, float length,
                          float time) {
    return leg_through(scene, inside, origin, direction, length, what_passes(), time).passed;
}

// A channel in proportion to what is carried; further digits of the choice are what is left of it.
inline LegQuestion ask_leg(uint kind, vec3 carried, vec2 u, float place) {
    LegQuestion question = what_passes();
    question.kind = kind;
    question.place = place;
    const float sum = carried.x + carried.y + carried.z;
    if (sum > 0.0f) question.weights = carried / sum;
    const vec3 w = question.weights;
    float first = 0.0f;
    float width = w.x;
    if (u.y >= w.x + w.y && w.z > 0.0f) {
        question.channel = 2u;
        first = w.x + w.y;
        width = w.z;
    } else if (u.y >= w.x && w.y > 0.0f) {
        question.channel = 1u;
        first = w.x;
        width = w.y;
    }
    const float rest = width > 0.0f ? clamp((u.y - first) / width, 0.0f, 0.99999994f) : 0.0f;
    question.u = vec2(u.x, rest);
    return question;
}

SHADING_END

#endif

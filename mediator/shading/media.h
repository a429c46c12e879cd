#ifndef TESSERA_MEDIATOR_SHADING_MEDIA_H
#define TESSERA_MEDIATOR_SHADING_MEDIA_H

#include "mediator/shading/containing_media.h"
#include "mediator/shading/volume_textures.h"

// Radiative transfer along a path segment: dL/ds = -(a + s) L + e + s x in-scattered light (Schwenk 5.B.3; e
// is not multiplied by a). Emission is integrated along the whole segment, whether the path scatters on it or
// not. The free flight distance is sampled by the extinction a + s of one colour channel, chosen in
// proportion to the path's throughput, and weighted by the density of all three (balance heuristic, Veach
// 1997), which preserves the throughput's sum over the channels but for absorption.
//
// In a textured medium the optical depth is accumulated over the cells of the textures' grids, by two-point
// Gaussian quadrature, which is exact for the cubic there. Distances are sampled with the cell's mean
// extinction and weighted by the actual one.
SHADING_BEGIN

inline constexpr uint SegmentTransmits = 0u;   // transmittance only
inline constexpr uint SegmentMayScatter = 1u;  // the path scatters on it or passes
inline constexpr uint SegmentScatters = 2u;    // forced scattering; the transmittance is needed as well

struct SegmentQuery {
    uint kind;
    vec3 weights;                // of the colour channels; sum 1
    uint channel;                // chosen by the weights
    vec2 u;                      // for the distance; the second holds further digits of the first
    float emission_sample;       // [0, 1): where emission is looked up
    float equiangular_distance;  // a second point to evaluate (equiangular.h), metres; < 0: none
};

struct PathSegment {
    vec3 passed;     // transmittance weight of the light from its end
    vec3 emitted;    // radiance emitted along it
    vec3 scattered;  // weight of the light in-scattered at `distance`, divided by the density
    float distance;  // of the scattering point
    bool scatters;
    float anisotropy;
    float density;              // of free flight sampling there, per metre
    vec3 equiangular;           // weight of the light in-scattered at the equiangular sample, per metre
    float equiangular_density;  // of free flight sampling there, per metre
};

inline PathSegment empty_segment() {
    return PathSegment(vec3(1.0f), vec3(0.0f), vec3(0.0f), 0.0f, false, 0.0f, 0.0f, vec3(0.0f), 0.0f);
}

inline float channel_value(vec3 v, uint channel) {
    return channel == 0u ? v.x : (channel == 1u ? v.y : v.z);
}

inline vec3 exponentials(vec3 x) {
    return vec3(exponential(x.x), exponential(x.y), exponential(x.z));
}

// 1 - exp(-x) for x >= 0, relative error below 2^-21.
inline float absorbed_fraction(float x) {
    if (x > 0.25f) return 1.0f - exponential(-x);
    const float p = 1.0f - x * (1.0f / 6.0f) * (1.0f - x * (1.0f / 7.0f));
    return x * (1.0f - 0.5f * x * (1.0f - x * (1.0f / 3.0f) * (1.0f - 0.25f * x * (1.0f - 0.2f * x * p))));
}

// -log(1 - v) for v in [0, 1): the optical depth at which a fraction v is absorbed. By the series of the
// inverse hyperbolic tangent where it is small.
inline float depth_of_fraction(float v) {
    if (v > 0.25f) return -logarithm(1.0f - v);
    const float s = v / (2.0f - v), s2 = s * s;
    return 2.0f * s * (1.0f + s2 * (1.0f / 3.0f + s2 * (0.2f + s2 * (1.0f / 7.0f))));
}

// Below this optical depth of the segment, the scattering point is chosen uniformly.
inline constexpr float ThinSegment = 1.0f / 4096.0f;

// The optical depth at which a path scatters; `whole`: of the segment.
inline float scattering_depth(uint kind, vec2 u, float whole) {
    if (kind == SegmentMayScatter) {
        return depth_of_fraction(lesser_of(u.x + u.y * 5.9604644775390625e-8f, 0.99999994f));
    }
    if (whole < ThinSegment) return u.x * whole;
    return lesser_of(depth_of_fraction(lesser_of(u.x * absorbed_fraction(whole), 0.99999994f)), whole);
}

// Its density, per optical depth.
inline float scattering_density(uint kind, float depth, float whole) {
    if (kind == SegmentMayScatter) return exponential(-depth);
    if (whole < ThinSegment) return whole > 0.0f ? 1.0f / whole : 0.0f;
    return exponential(-depth) / absorbed_fraction(whole);
}

// Combined density of all colour channels, per metre.
inline float scattering_densities(IN(SegmentQuery) query, vec3 rate, vec3 depth, vec3 whole) {
    return query.weights.x * rate.x * scattering_density(query.kind, depth.x, whole.x) +
           query.weights.y * rate.y * scattering_density(query.kind, depth.y, whole.y) +
           query.weights.z * rate.z * scattering_density(query.kind, depth.z, whole.z);
}

// Transmittance, divided by the probability of passing.
inline vec3 transmitted_weight(IN(SegmentQuery) query, vec3 whole) {
    const vec3 passed = exponentials(-whole);
    if (query.kind != SegmentMayScatter) return passed;
    const float probability = dot(query.weights, passed);
    return probability > 0.0f ? passed / probability : vec3(0.0f);
}

inline vec3 scattered_weight(vec3 scattering, vec3 depth, float density) {
    return density > 0.0f ? scattering * exponentials(-depth) / density : vec3(0.0f);
}

// Fraction of uniform emission along an optical depth that leaves the segment.
inline float emitted_fraction(float depth) {
    return depth > 0.0f ? absorbed_fraction(depth) / depth : 1.0f;
}

inline PathSegment segment_through_homogeneous(IN(Medium) medium, float length, IN(SegmentQuery) query) {
    PathSegment segment = empty_segment();
    const vec3 extinction = medium.absorption + medium.scattering;
    const vec3 whole = extinction * length;
    segment.emitted = medium.emission * length *
                      vec3(emitted_fraction(whole.x), emitted_fraction(whole.y), emitted_fraction(whole.z));
    segment.passed = transmitted_weight(query, whole);
    if (query.kind == SegmentTransmits) return segment;
    const float rate = channel_value(extinction, query.channel);
    const float all = channel_value(whole, query.channel);
    if (query.equiangular_distance >= 0.0f) {
        const vec3 there = extinction * query.equiangular_distance;
        segment.equiangular = medium.scattering * exponentials(-there);
        segment.equiangular_density = scattering_densities(query, extinction, there, whole);
    }
    const float depth = scattering_depth(query.kind, query.u, all);
    if (!(depth < all)) return segment;
    segment.scatters = true;
    segment.distance = lesser_of(depth / rate, length);
    const vec3 depths = extinction * segment.distance;
    // Over the largest rate, so that products stay in range.
    const float most = largest(extinction), scale = 1.0f / most;
    const float density = scattering_densities(query, extinction * scale, depths, whole);
    segment.scattered = scattered_weight(medium.scattering * scale, depths, density);
    segment.density = density * most;
    return segment;
}

struct Coefficients {
    vec3 extinction;
    vec3 scattering;
};

inline vec3 medium_texel(IN(Scene) scene, IN(Medium) medium, uint texture, vec3 at) {
    if (medium.textures[texture].texture < 0) return vec3(1.0f);
    return lookup_volume(scene, scene.textures.items[medium.textures[texture].texture],
                         volume_place(medium.textures[texture], at));
}

inline Coefficients coefficients_at(IN(Scene) scene, IN(Medium) medium, IN(BoxRay) ray, float distance) {
    const vec3 at = ray.origin + distance * ray.direction;
    vec3 texels[2];
    NO_UNROLL
    for (uint i = 0u; i < 2u; ++i) texels[i] = medium_texel(scene, medium, i, at);
    const vec3 scattering = medium.scattering * texels[MediumScattering];
    return Coefficients(medium.absorption * texels[MediumAbsorption] + scattering, scattering);
}

// Mean extinction over a part of a cell: two-point Gaussian quadrature.
inline vec3 mean_extinction(IN(Scene) scene, IN(Medium) medium, IN(BoxRay) ray, float near, float far) {
    vec3 sum = vec3(0.0f);
    NO_UNROLL
    for (uint i = 0u; i < 2u; ++i) {
        const float fraction = i == 0u ? 0.211324865f : 0.788675135f;
        sum += coefficients_at(scene, medium, ray, near + fraction * (far - near)).extinction;
    }
    return 0.5f * sum;
}

// Emission of a cell, looked up at one point that is sampled in proportion to the transmittance from there.
inline vec3 cell_emission(IN(Scene) scene, IN(Medium) medium, IN(BoxRay) ray, float near, float far,
                          vec3 rate, float choice) {
    const float grey_rate = (rate.x + rate.y + rate.z) * (1.0f / 3.0f);
    const float whole = grey_rate * (far - near);
    const bool thin = whole < ThinSegment;
    const float depth = scattering_depth(SegmentScatters, vec2(choice, 0.0f), whole);
    const float place = thin ? near + choice * (far - near) : near + depth / grey_rate;
    const float density =
        thin ? 1.0f / (far - near) : grey_rate * scattering_density(SegmentScatters, depth, whole);
    const vec3 passed = exponentials(-mean_extinction(scene, medium, ray, near, place) * (place - near));
    const vec3 texel = medium_texel(scene, medium, MediumEmission, ray.origin + place * ray.direction);
    return medium.emission * texel * passed / density;
}

// Maximum cells per segment; the last one extends to its end, however fine the textures are.
inline constexpr uint MaxCells = 16384u;
inline constexpr float GoldenRatio = 0.618033989f;

inline PathSegment segment_through_grid(IN(Scene) scene, IN(Medium) medium, IN(BoxRay) ray, float length,
                                        IN(SegmentQuery) query) {
    PathSegment segment = empty_segment();
    const bool emits = largest(medium.emission) > 0.0f;
    vec3 whole = vec3(0.0f);  // optical depth of the segment, known after the first pass
    // Two passes if the distance depends on the total optical depth.
    NO_UNROLL
    for (uint pass = query.kind == SegmentScatters ? 0u : 1u; pass < 2u; ++pass) {
        float wanted = infinity();
        if (pass == 1u && query.kind != SegmentTransmits) {
            wanted = scattering_depth(query.kind, query.u, channel_value(whole, query.channel));
        }
        vec3 depth = vec3(0.0f);
        float near = 0.0f;
        NO_UNROLL
        for (uint cell = 1u;
             near < length && !(segment.scatters && !emits && near > query.equiangular_distance); ++cell) {
            const float next = cell < MaxCells ? next_cell(scene, medium, ray, near) : length;
            const float far = lesser_of(next, length);
            const vec3 rate = mean_extinction(scene, medium, ray, near, far);
            if (pass == 1u && emits) {
                float choice = query.emission_sample + float(cell) * GoldenRatio;
                choice -= floor(choice);
                segment.emitted +=
                    exponentials(-depth) * cell_emission(scene, medium, ray, near, far, rate, choice);
            }
            const vec3 after = depth + rate * (far - near);
            const bool scatters_here =
                pass == 1u && !segment.scatters && channel_value(after, query.channel) > wanted;
            const bool has_equiangular = pass == 1u && query.equiangular_distance >= near &&
                                         (query.equiangular_distance < far || !(far < length));
            NO_UNROLL
            for (uint place = scatters_here ? 0u : 1u; place < (has_equiangular ? 2u : 1u); ++place) {
                const float rest = wanted - channel_value(depth, query.channel);
                const float part = place == 1u
                                       ? lesser_of(query.equiangular_distance, far) - near
                                       : clamp(rest / channel_value(rate, query.channel), 0.0f, far - near);
                const vec3 there = depth + part * mean_extinction(scene, medium, ray, near, near + part);
                const vec3 scattering = coefficients_at(scene, medium, ray, near + part).scattering;
                const float density = scattering_densities(query, rate, depth + part * rate, whole);
                if (place == 1u) {
                    segment.equiangular = scattering * exponentials(-there);
                    segment.equiangular_density = density;
                } else {
                    segment.scatters = true;
                    segment.distance = near + part;
                    segment.scattered = scattered_weight(scattering, there, density);
                    segment.density = density;
                }
            }
            depth = after;
            near = far;
        }
        if (!(near < length)) whole = depth;
    }
    segment.passed = transmitted_weight(query, whole);
    return segment;
}

inline PathSegment segment_in_medium(IN(Scene) scene, IN(Medium) medium, uint instance, vec3 origin,
                                     vec3 direction, float length, IN(SegmentQuery) requested, float time) {
    SegmentQuery query = requested;
    const bool scatters = (scene.features & FeatureScattering) != 0u && largest(medium.scattering) > 0.0f;
    if (!scatters) query.kind = SegmentTransmits;
    if (query.kind == SegmentTransmits) query.equiangular_distance = -1.0f;
    if ((scene.features & FeatureMediaTextures) != 0u && medium.textured != 0u) {
        const BoxRay ray =
            box_ray(instance_at(scene, scene.instances.items[instance], time), medium, origin, direction);
        return segment_through_grid(scene, medium, ray, length, query);
    }
    return segment_through_homogeneous(medium, length, query);
}

// A straight segment of this length (metres). Media are closed meshes, so a ray that leaves the scene has
// left its media at their last surface.
inline PathSegment segment_through(IN(Scene) scene, uvec4 containing_media, vec3 origin, vec3 direction,
                                   float length, IN(SegmentQuery) query, float time) {
    if ((scene.features & FeatureMedia) == 0u || containing_media.x == NoInstance || !is_finite(length)) {
        return empty_segment();
    }
    const int index = scene.instances.items[containing_media.x].medium;
    PathSegment segment = segment_in_medium(scene, scene.media.items[index], containing_media.x, origin,
                                            direction, length, query, time);
    segment.anisotropy = scene.media.items[index].anisotropy;
    return segment;
}

inline SegmentQuery transmittance_query() {
    return SegmentQuery(SegmentTransmits, vec3(1.0f / 3.0f), 0u, vec2(0.0f), 0.0f, -1.0f);
}

inline vec3 transmittance(IN(Scene) scene, uvec4 containing_media, vec3 origin, vec3 direction, float length,
                          float time) {
    return segment_through(scene, containing_media, origin, direction, length, transmittance_query(), time)
        .passed;
}

// Chooses a colour channel in proportion to the throughput; the rescaled random number is reused.
inline SegmentQuery segment_query(uint kind, vec3 carried, vec2 u, float place) {
    SegmentQuery query = transmittance_query();
    query.kind = kind;
    query.emission_sample = place;
    const float sum = carried.x + carried.y + carried.z;
    if (sum > 0.0f) query.weights = carried / sum;
    const vec3 w = query.weights;
    float first = 0.0f;
    float width = w.x;
    if (u.y >= w.x + w.y && w.z > 0.0f) {
        query.channel = 2u;
        first = w.x + w.y;
        width = w.z;
    } else if (u.y >= w.x && w.y > 0.0f) {
        query.channel = 1u;
        first = w.x;
        width = w.y;
    }
    const float rest = width > 0.0f ? clamp((u.y - first) / width, 0.0f, 0.99999994f) : 0.0f;
    query.u = vec2(u.x, rest);
    return query;
}

SHADING_END

#endif

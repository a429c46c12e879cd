#ifndef TESSERA_MEDIATOR_SHADING_PATHS_H
#define TESSERA_MEDIATOR_SHADING_PATHS_H

#include "mediator/shading/bodies.h"
#include "mediator/shading/cones.h"
#include "mediator/shading/maths.h"
#include "mediator/shading/path_sample.h"
#include "mediator/shading/sobol.h"

// What a path carries.
SHADING_BEGIN

// All that decides for which channels the light of a path counts.
struct Way {
    uint scatterings;    // between light and eye, from the first non-delta hit on
    bool last_is_delta;  // of all, next to the light
    vec3 diffuse_share;  // of its light: what the diffuse lobe of the first non-delta hit passed on
};

// What perfect speculars have made of a path.
struct Chain {
    bool has_one_channel;  // of channel_of: the others went other ways
    int environment;       // index of the shader whose environment it sees; -1: no more than the sky
};

// Where a path is: what it still carries and what it has gathered.
struct Path {
    Sampler numbers;
    uint vertex;  // surfaces scattered at so far
    vec3 throughput;
    float probability;  // of this branch, where all branches are followed
    float bsdf_pdf;     // of the direction it travels; 0 = from the camera or a perfect specular
    vec3 last_position;
    vec3 last_normal;  // of the receiver there (light_tree.h)
    Cone cone;
    Chain chain;
    uvec4 inside;  // what the ray goes through (bodies.h)
    Way way;       // that light takes which is found next
    PathSample found;
    uint rays;
};

inline Way direct_way() {
    return Way(0u, false, vec3(0.0f));
}

inline PathSample nothing_found() {
    return PathSample(vec3(0.0f), vec3(0.0f), vec3(0.0f), 0.0f, vec3(0.0f), vec3(0.0f), vec3(0.0f),
                      infinity(), 0u, 0.0f);
}

inline Path start_path(IN(Sampler) numbers) {
    return Path(numbers, 0u, vec3(1.0f), 1.0f, 0.0f, vec3(0.0f), vec3(0.0f), Cone(0.0f, 0.0f),
                Chain(false, -1), nowhere(), direct_way(), nothing_found(), 0u);
}

// Red, green or blue: in turn, from sample to sample.
inline uint channel_of(IN(Sampler) numbers) {
    return (numbers.index % 3u + numbers.seed % 3u) % 3u;
}

// Seeds of the two kinds of rays at a vertex, for surfaces with alpha.
inline uint closest_seed(IN(Path) path) {
    return hash_combine(hash_combine(path.numbers.seed, path.numbers.index), 2u * path.vertex);
}
inline uint shadow_seed(IN(Path) path) {
    return hash_combine(hash_combine(path.numbers.seed, path.numbers.index), 2u * path.vertex + 1u);
}

// Pairs of random numbers: the first is the camera's, then each vertex has its own.
inline constexpr uint CameraPair = 0u;
inline constexpr uint LensPair = 0xffffffffu;  // no vertex comes so far
inline constexpr uint PairBsdfDirection = 0u, PairLobeAndRoulette = 1u, PairLightChoice = 2u,
                      PairLightPoint = 3u, PairsPerVertex = 4u;
inline constexpr uint TimePair = 0xfffffffeu;  // nor here
// A place in a medium that a branch of perfect speculars (speculars.h) is scattered at has the numbers of no
// surface.
inline constexpr uint MediumVertex = 0x10000000u;

// Of a leg from a vertex on through media: by how many there were before it.
inline uint leg_pair(uint vertex, uint number) {
    return 0x80000000u + (vertex * 64u + (number & 63u)) % 0x7ffffff0u;
}

// When a sample is taken, as a share of the time that the shutter is open; 0 where nothing moves.
inline float sample_time(FeatureBits features, IN(View) view, uint x, uint y, uint64_t index) {
    if ((features & (FeatureMotion | FeatureCameraMotion)) == 0u) return 0.0f;
    return sample_pair(make_sampler(x, y, view.seed, index), TimePair).x;
}

inline vec2 pair_at(IN(Path) path, uint pair) {
    return sample_pair(path.numbers, 1u + path.vertex * PairsPerVertex + pair);
}

// BT.601, as the thesis' filter was tuned with (Lardinoije 2.2).
inline float grey(vec3 color) {
    return dot(color, vec3(0.299f, 0.587f, 0.114f));
}

inline bool keeps(IN(View) view, uint what) {
    return (view.keeps & what) != 0u;
}

// Sorts light into the sample's path classes, as the view asks for.
inline void add_light(INOUT(PathSample) found, IN(View) view, vec3 light, IN(Way) way) {
    const vec3 diffuse = keeps(view, KeepsDiffuse) ? light * way.diffuse_share : vec3(0.0f);
    found.diffuse += diffuse;
    if (view.path_class == ClassDiffuse) {
        found.high += diffuse;
        found.low += light - diffuse;
        return;
    }
    const bool indirect = way.scatterings > 1u;
    const bool high = view.path_class == ClassAll || (view.path_class == ClassIndirect && indirect) ||
                      (view.path_class == ClassCaustics && indirect && way.last_is_delta);
    if (high) {
        found.high += light;
    } else {
        found.low += light;
    }
}

// A light that a path reaches, by its own intensity.
inline void connect_light(INOUT(PathSample) found, IN(View) view, vec3 intensity) {
    if (keeps(view, KeepsConnections)) found.connections += grey(intensity);
}

inline vec3 radiance_of(IN(PathSample) found) {
    return found.low + found.high;
}

// Diffuse light without the albedo; 0 where that is 0.
inline vec3 irradiance_of(IN(PathSample) found) {
    return vec3(found.albedo.x > 0.0f ? found.diffuse.x / found.albedo.x : 0.0f,
                found.albedo.y > 0.0f ? found.diffuse.y / found.albedo.y : 0.0f,
                found.albedo.z > 0.0f ? found.diffuse.z / found.albedo.z : 0.0f);
}

// Lardinoije 2.2
inline float shading_feature_of(IN(PathSample) found, uint rule) {
    if (rule == RuleConnections) return found.connections;
    return grey(irradiance_of(found)) + greater_of(grey(radiance_of(found) - found.diffuse), 0.0f);
}

SHADING_END

#endif

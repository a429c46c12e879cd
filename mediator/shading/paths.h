#ifndef TESSERA_MEDIATOR_SHADING_PATHS_H
#define TESSERA_MEDIATOR_SHADING_PATHS_H

#include "mediator/shading/containing_media.h"
#include "mediator/shading/maths.h"
#include "mediator/shading/path_sample.h"
#include "mediator/shading/ray_cones.h"
#include "mediator/shading/sampler.h"

// The state of a path.
SHADING_BEGIN

// What determines to which path class the light of a path is added.
struct PathClassInfo {
    uint scatter_count;     // scattering events from the first non-delta hit on
    bool last_is_delta;     // the last event before the light
    vec3 diffuse_fraction;  // of the light: by the diffuse lobe of the first non-delta hit
};

// State of a chain of perfect speculars.
struct SpecularChain {
    bool is_single_channel;  // only the colour channel of channel_of is left (dispersion)
    int environment;         // index of the surface shader whose environment it sees; -1: the sky only
};

// A path: what it carries, and what it has gathered so far.
struct Path {
    Sampler numbers;
    uint vertex;     // scattering events so far
    uint walls;      // of them straight through thin walls: no scattering, and not limited
    uint speculars;  // of them by perfect speculars otherwise
    vec3 throughput;
    float probability;  // of this branch, if all branches are followed
    float bsdf_pdf;     // of its direction; 0 = from the camera or a perfect specular
    vec3 last_position;
    vec3 last_normal;    // of the receiver there (light_tree.h)
    uint last_sky_cell;  // of the same
    RayCone cone;
    SpecularChain chain;
    uvec4 containing_media;    // media that the ray is in (containing_media.h)
    PathClassInfo class_info;  // of the light that is added next
    PathSample found;
    uint rays;
};

inline PathClassInfo direct_class_info() {
    return PathClassInfo(0u, false, vec3(0.0f));
}

inline PathSample empty_path_sample() {
    return PathSample(vec3(0.0f), vec3(0.0f), vec3(0.0f), 0.0f, vec3(0.0f), vec3(0.0f), vec3(0.0f),
                      infinity(), 0u, 0.0f);
}

inline Path start_path(IN(Sampler) numbers) {
    return Path(numbers, 0u, 0u, 0u, vec3(1.0f), 1.0f, 0.0f, vec3(0.0f), vec3(0.0f), NoSkyCell,
                RayCone(0.0f, 0.0f), SpecularChain(false, -1), no_media(), direct_class_info(),
                empty_path_sample(), 0u);
}

// Red, green or blue: in turn, from sample to sample.
inline uint channel_of(IN(Sampler) numbers) {
    return (numbers.index % 3u + numbers.seed % 3u) % 3u;
}

// Unlit surfaces (KHR_materials_unlit) are shown as they are, to the camera and in perfect speculars. Otherwise they
// neither send light nor stop it, as in rasterisers.
inline bool passes_unlit(IN(Path) path) {
    return path.class_info.scatter_count > 0u;
}

// Whether the path may scatter once more, by a perfect specular or otherwise.
inline bool may_scatter(IN(Path) path, IN(View) view, bool is_specular) {
    return is_specular ? path.speculars < view.max_specular_events
                       : path.vertex - path.walls - path.speculars < view.max_scatter_events;
}

// Sequences of the two kinds of rays at a vertex, for surfaces with alpha.
inline constexpr uint AlphaSequences = 0x60000000u;
inline Sampler path_ray_numbers(IN(Path) path) {
    return Sampler(path.numbers.index, hash_combine(path.numbers.seed, AlphaSequences + 2u * path.vertex));
}
inline Sampler shadow_ray_numbers(IN(Path) path) {
    return Sampler(path.numbers.index,
                   hash_combine(path.numbers.seed, AlphaSequences + 2u * path.vertex + 1u));
}

// Sets of random numbers (sampler.h). The camera's: place in the pixel, and the point on the light that the path's
// first rough vertex samples, since penumbrae in a pixel depend on these four together. Then each vertex has two:
// direction, lobe and roulette; choice of a light and point on it.
inline constexpr uint CameraSet = 0u, ScatterSet = 1u, LightSet = 2u, SetsPerVertex = 2u;
inline constexpr uint LensSet = 0xffffffffu;  // place in the aperture, and time; beyond all vertices
// Offset of the vertex index for scattering points in a medium on a branch of perfect speculars
// (specular_branches.h): a disjoint range of RNG dimensions.
inline constexpr uint MediumVertex = 0x10000000u;

// Set of a segment after a vertex; `number`: index of the segment.
inline uint segment_set(uint vertex, uint number) {
    return 0x80000000u + (vertex * 64u + (number & 63u)) % 0x7ffffff0u;
}

// Time of a sample, 0 to 1 over the shutter; 0 if nothing moves.
inline float sample_time(FeatureBits features, IN(View) view, uint x, uint y, uint64_t index) {
    if ((features & (FeatureMotion | FeatureCameraMotion)) == 0u) return 0.0f;
    return second_pair(sample_set(make_sampler(x, y, view.seed, index), LensSet)).x;
}

inline SampleSet set_at(IN(Path) path, uint set) {
    return sample_set(path.numbers, path.vertex * SetsPerVertex + set);
}

// The numbers for the choice of a light, and for a point on it.
inline vec4 light_numbers(IN(Path) path) {
    const SampleSet light = set_at(path, LightSet);
    if (path.vertex == path.walls + path.speculars)
        return vec4(first_pair(light), second_pair(sample_set(path.numbers, CameraSet)));
    return vec4(first_pair(light), second_pair(light));
}

// BT.601, as the thesis' filter was tuned with (Lardinoije 2.2).
inline float grey(vec3 color) {
    return dot(color, vec3(0.299f, 0.587f, 0.114f));
}

inline bool records(IN(View) view, uint quantity) {
    return (view.recorded_quantities & quantity) != 0u;
}

// The light that a path adds at one vertex, scaled so that no component exceeds the view's limit, if it is
// indirect. The mean of the samples is then too dark wherever paths exceed the limit.
inline vec3 clamped(IN(View) view, vec3 light, IN(PathClassInfo) class_info) {
    if (view.clamp_indirect <= 0.0f || class_info.scatter_count < 2u) return light;
    const float most = greater_of(greater_of(abs(light.x), abs(light.y)), abs(light.z));
    return most > view.clamp_indirect ? light * (view.clamp_indirect / most) : light;
}

// Adds light to the sample's path classes, as the view requests.
inline void add_light(INOUT(PathSample) found, IN(View) view, vec3 unclamped, IN(PathClassInfo) class_info) {
    const vec3 light = clamped(view, unclamped, class_info);
    const vec3 diffuse = records(view, RecordsDiffuse) ? light * class_info.diffuse_fraction : vec3(0.0f);
    found.diffuse += diffuse;
    if (view.path_class == ClassDiffuse) {
        found.high += diffuse;
        found.low += light - diffuse;
        return;
    }
    const bool indirect = class_info.scatter_count > 1u;
    const bool high = view.path_class == ClassAll || (view.path_class == ClassIndirect && indirect) ||
                      (view.path_class == ClassCaustics && indirect && class_info.last_is_delta);
    if (high) {
        found.high += light;
    } else {
        found.low += light;
    }
}

// Records the intensity of a light that a path reaches.
inline void connect_light(INOUT(PathSample) found, IN(View) view, vec3 intensity) {
    if (records(view, RecordsConnections)) found.connections += grey(intensity);
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

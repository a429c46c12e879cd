#ifndef TESSERA_MEDIATOR_SHADING_LIGHT_TREE_H
#define TESSERA_MEDIATOR_SHADING_LIGHT_TREE_H

#include "mediator/shading/maths.h"
#include "mediator/shading/records.h"
#include "mediator/shading/sampler.h"

// Chooses one emitter by descending the light tree, at each node with probabilities in proportion to the
// importance of its children for a receiver (Conty Estevez and Kulla 2018). Every emitter has a probability
// above 0 from every receiver: a poor importance estimate costs noise, never bias.
SHADING_BEGIN

// A point that light is sampled for. Normal 0: light from all directions.
struct Receiver {
    vec3 position;
    vec3 normal;
    vec3 span;      // to its other end, if it is a segment in a medium; else 0
    uint sky_cell;  // of a surface (sky_cells.h); NoSkyCell: none
};

// The receiver's nearest point to another point.
inline vec3 nearest_point(IN(Receiver) receiver, vec3 to) {
    const float length2 = dot(receiver.span, receiver.span);
    if (!(length2 > 0.0f)) return receiver.position;
    const float fraction = dot(to - receiver.position, receiver.span) / length2;
    return receiver.position + clamp(fraction, 0.0f, 1.0f) * receiver.span;
}

// Emitters that face away keep this fraction of their importance. If half of the emission faces away, 1
// choice in 1024 is wasted.
inline constexpr float MinFacing = 1.0f / 1024.0f;

// cos(max(0, angle - half angle of the cone)), both given by their cosines.
inline float cosine_beyond(float cosine, float cosine_of_cone) {
    const float sines2 =
        (1.0f - cosine) * (1.0f + cosine) * ((1.0f - cosine_of_cone) * (1.0f + cosine_of_cone));
    const float beyond = cosine * cosine_of_cone + sqrt(greater_of(sines2, 0.0f));
    return cosine >= cosine_of_cone ? 1.0f : beyond;
}

// Importance of a node, in units of the tree's power / (the tree's extent)^2. The cosines are upper bounds
// over the bounding sphere: 0 if all of it faces away or is below the receiver's horizon. Beyond 1000 extents
// all emitters are about equally far. A span uses the mean irradiance along it, of a node that emits
// isotropically.
inline constexpr float MinDistance2 = 1e-36f, MaxDistance2 = 1e6f;
inline float expected_light(IN(LightNode) node, IN(Receiver) receiver, float scale) {
    const vec3 to_node = (node.center - nearest_point(receiver, node.center)) * scale;
    const float distance2 = lesser_of(greater_of(dot(to_node, to_node), MinDistance2), MaxDistance2);
    const float inverse = 1.0f / sqrt(distance2);
    const float radius = node.radius * scale;
    if (dot(receiver.span, receiver.span) > 0.0f) {
        const float nearest = greater_of(sqrt(distance2), radius);
        return node.power / (nearest * (nearest + vector_length(receiver.span) * scale));
    }
    const float sine_of_ball = radius * inverse;
    const float cosine_axis = -dot(node.axis, to_node) * inverse;
    const bool two_sided = (node.link & LightTwoSided) != 0u;
    const float leaves =
        sine_of_ball + cosine_beyond(two_sided ? abs(cosine_axis) : cosine_axis, node.cos_spread);
    const float arrives =
        sine_of_ball + (receiver.normal == vec3(0.0f) ? 1.0f : dot(receiver.normal, to_node) * inverse);
    const float facing = lesser_of(leaves, 1.0f) * lesser_of(arrives, 1.0f);
    const bool shines = leaves > node.cos_emission_angle && arrives > 0.0f;
    const float expected = node.power * (shines ? greater_of(facing, MinFacing) : MinFacing);
    return sine_of_ball > 1.0f ? expected / (radius * radius) : expected * (inverse * inverse);
}

// Probabilities of a node's children, each at least a millionth.
struct ChildProbabilities {
    uint first;
    uint count;
    float items[MaxLightChildren];
};

inline ChildProbabilities child_probabilities(IN(Scene) scene, uint link, IN(Receiver) receiver) {
    ChildProbabilities probabilities;
    probabilities.first = link & LightIndexBits;
    probabilities.count = ((link >> LightCountShift) & 3u) + 1u;
    const bool by_power = (link & LightByPower) != 0u;
    float sum = 0.0f;
    NO_UNROLL
    for (uint i = 0u; i < probabilities.count; ++i) {
        probabilities.items[i] = by_power ? scene.light_nodes.items[probabilities.first + i].power
                                          : expected_light(scene.light_nodes.items[probabilities.first + i],
                                                           receiver, scene.tree_scale);
        sum += probabilities.items[i];
    }
    const float least = 1e-6f * sum;
    const float inverse = 1.0f / (sum + float(probabilities.count) * least);
    for (uint i = 0u; i < probabilities.count; ++i)
        probabilities.items[i] = (probabilities.items[i] + least) * inverse;
    return probabilities;
}

struct ChosenEmitter {
    uint index;
    float probability;  // 0: none is chosen
};

inline ChosenEmitter no_emitter() {
    return ChosenEmitter(0u, 0.0f);
}

// A random number has 24 bits, which the decisions use up. When they run short the second number is used, and
// then a hash of both.
inline constexpr float MinRemainingProbability = 1.0f / 256.0f;
inline ChosenEmitter choose_emitter(IN(Scene) scene, IN(Receiver) receiver, vec2 choice) {
    float probability = 1.0f;
    float u = choice.x;
    float before = 1.0f;  // the probability when this u was taken
    uint link = scene.light_nodes.items[0].link;
    NO_UNROLL
    while ((scene.features & FeatureLightTree) != 0u && (link & LightLeaf) == 0u) {
        const ChildProbabilities probabilities = child_probabilities(scene, link, receiver);
        uint at = 0u;
        float low = 0.0f, high = probabilities.items[0], part = high;
        for (uint i = 1u; i < probabilities.count; ++i) {
            const bool is_beyond = u >= high;
            at = is_beyond ? i : at;
            low = is_beyond ? high : low;
            part = is_beyond ? probabilities.items[i] : part;
            high += probabilities.items[i];
        }
        u = lesser_of((u - low) / part, 0.99999994f);
        probability *= part;
        link = scene.light_nodes.items[probabilities.first + at].link;
        if (probability < MinRemainingProbability * before) {
            const uint bits = hash_combine(hash_combine(float_bits(choice.x), float_bits(choice.y)), link);
            u = before == 1.0f ? choice.y : unit_float(bits);
            before = probability;
        }
    }
    return ChosenEmitter(link & LightIndexBits, probability);
}

// Probability with which choose_emitter finds a leaf.
inline float leaf_probability(IN(Scene) scene, uint leaf, IN(Receiver) receiver) {
    float probability = 1.0f;
    if ((scene.features & FeatureLightTree) == 0u) return probability;
    uint at = leaf;
    NO_UNROLL
    while (at != 0u) {
        const uint parent = scene.light_nodes.items[at].parent;
        const ChildProbabilities probabilities =
            child_probabilities(scene, scene.light_nodes.items[parent].link, receiver);
        probability *= probabilities.items[at - probabilities.first];
        at = parent;
    }
    return probability;
}

SHADING_END

#endif

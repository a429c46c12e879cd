#ifndef TESSERA_MEDIATOR_SHADING_LIGHT_TREE_H
#define TESSERA_MEDIATOR_SHADING_LIGHT_TREE_H

#include "mediator/shading/maths.h"
#include "mediator/shading/records.h"
#include "mediator/shading/sobol.h"

// One emitter out of many: down a tree, from children to children, each with a probability in proportion
// to the light that a receiver may expect of it (Conty Estevez and Kulla 2018). Every emitter has a chance
// from everywhere: a wrong expectation costs noise, never light.
SHADING_BEGIN

// Where light arrives. A normal of 0: it is welcome from all sides.
struct Receiver {
    vec3 position;
    vec3 normal;
    vec3 way;  // to its other end, where it is a straight way through a medium; else 0
};

// The place of it that is nearest to another.
inline vec3 nearest_place(IN(Receiver) receiver, vec3 to) {
    const float way2 = dot(receiver.way, receiver.way);
    if (!(way2 > 0.0f)) return receiver.position;
    const float share = dot(to - receiver.position, receiver.way) / way2;
    return receiver.position + clamp(share, 0.0f, 1.0f) * receiver.way;
}

// What is turned away counts as if it shone with this share. Where as much light is turned away as comes, one
// choice in 1024 is lost to it.
inline constexpr float LeastFacing = 1.0f / 1024.0f;

// Cosine of an angle less the half angle of a cone, at least of 0. Both by their cosines.
inline float cosine_beyond(float cosine, float cosine_of_cone) {
    const float sines2 =
        (1.0f - cosine) * (1.0f + cosine) * ((1.0f - cosine_of_cone) * (1.0f + cosine_of_cone));
    const float beyond = cosine * cosine_of_cone + sqrt(greater_of(sines2, 0.0f));
    return cosine >= cosine_of_cone ? 1.0f : beyond;
}

// The light that may be expected of a node, in units of the tree's power / (the tree's size)^2. The cosines
// are the most favourable that a point of the ball may have, or some more: they are 0 where all of the ball
// is turned away, or below the receiver's horizon. From 1000 sizes on all emitters are about as far away.
// A way expects what arrives on the mean, from a node that shines evenly.
inline constexpr float LeastDistance2 = 1e-36f, MostDistance2 = 1e6f;
inline float expected_light(IN(LightNode) node, IN(Receiver) receiver, float scale) {
    const vec3 way = (node.middle - nearest_place(receiver, node.middle)) * scale;
    const float distance2 = lesser_of(greater_of(dot(way, way), LeastDistance2), MostDistance2);
    const float inverse = 1.0f / sqrt(distance2);
    const float radius = node.radius * scale;
    if (dot(receiver.way, receiver.way) > 0.0f) {
        const float nearest = greater_of(sqrt(distance2), radius);
        return node.power / (nearest * (nearest + vector_length(receiver.way) * scale));
    }
    const float sine_of_ball = radius * inverse;
    const float cosine_axis = -dot(node.axis, way) * inverse;
    const bool two_sided = (node.link & LightTwoSided) != 0u;
    const float leaves =
        sine_of_ball + cosine_beyond(two_sided ? abs(cosine_axis) : cosine_axis, node.cos_spread);
    const float arrives =
        sine_of_ball + (receiver.normal == vec3(0.0f) ? 1.0f : dot(receiver.normal, way) * inverse);
    const float facing = lesser_of(leaves, 1.0f) * lesser_of(arrives, 1.0f);
    const bool shines = leaves > node.cos_reach && arrives > 0.0f;
    const float share = node.power * (shines ? greater_of(facing, LeastFacing) : LeastFacing);
    return sine_of_ball > 1.0f ? share / (radius * radius) : share * (inverse * inverse);
}

// Probabilities of a node's children; none is less likely than a millionth.
struct ChildShares {
    uint first;
    uint count;
    float items[MaxLightChildren];
};

inline ChildShares child_shares(IN(Scene) scene, uint link, IN(Receiver) receiver) {
    ChildShares shares;
    shares.first = link & LightIndexBits;
    shares.count = ((link >> LightCountShift) & 3u) + 1u;
    const bool by_power = (link & LightByPower) != 0u;
    float sum = 0.0f;
    KEEP_LOOP
    for (uint i = 0u; i < shares.count; ++i) {
        shares.items[i] =
            by_power ? scene.light_nodes.items[shares.first + i].power
                     : expected_light(scene.light_nodes.items[shares.first + i], receiver, scene.tree_scale);
        sum += shares.items[i];
    }
    const float least = 1e-6f * sum;
    const float inverse = 1.0f / (sum + float(shares.count) * least);
    for (uint i = 0u; i < shares.count; ++i) shares.items[i] = (shares.items[i] + least) * inverse;
    return shares;
}

struct ChosenEmitter {
    uint index;
    float probability;  // 0: none is chosen
};

inline ChosenEmitter no_emitter() {
    return ChosenEmitter(0u, 0.0f);
}

// A random number decides until its bits run short: 24 of them, of which a decision needs some more than its
// share. Then the second goes on, and then a hash of both.
inline constexpr float UsedUp = 1.0f / 256.0f;
inline ChosenEmitter choose_emitter(IN(Scene) scene, IN(Receiver) receiver, vec2 choice) {
    float probability = 1.0f;
    float u = choice.x;
    float before = 1.0f;  // the probability with which this u began
    uint link = scene.light_nodes.items[0].link;
    KEEP_LOOP
    while ((scene.features & FeatureLightTree) != 0u && (link & LightLeaf) == 0u) {
        const ChildShares shares = child_shares(scene, link, receiver);
        uint at = 0u;
        float low = 0.0f, high = shares.items[0], part = high;
        for (uint i = 1u; i < shares.count; ++i) {
            const bool is_beyond = u >= high;
            at = is_beyond ? i : at;
            low = is_beyond ? high : low;
            part = is_beyond ? shares.items[i] : part;
            high += shares.items[i];
        }
        u = lesser_of((u - low) / part, 0.99999994f);
        probability *= part;
        link = scene.light_nodes.items[shares.first + at].link;
        if (probability < UsedUp * before) {
            const uint bits = hash_combine(hash_combine(float_bits(choice.x), float_bits(choice.y)), link);
            u = before == 1.0f ? choice.y : unit_float(bits);
            before = probability;
        }
    }
    return ChosenEmitter(link & LightIndexBits, probability);
}

// With which choose_emitter finds a leaf.
inline float leaf_probability(IN(Scene) scene, uint leaf, IN(Receiver) receiver) {
    float probability = 1.0f;
    if ((scene.features & FeatureLightTree) == 0u) return probability;
    uint at = leaf;
    KEEP_LOOP
    while (at != 0u) {
        const uint parent = scene.light_nodes.items[at].parent;
        const ChildShares shares = child_shares(scene, scene.light_nodes.items[parent].link, receiver);
        probability *= shares.items[at - shares.first];
        at = parent;
    }
    return probability;
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_LIGHT_CHOICE_H
#define TESSERA_MEDIATOR_SHADING_LIGHT_CHOICE_H

#include "mediator/shading/light_tree.h"
#include "mediator/shading/sky_cells.h"

// Chooses between the light tree and the infinite lights, by the irradiance of each at the receiver if nothing
// occludes it. An estimate that is far off costs noise, never bias.
SHADING_BEGIN

// What is shared evenly among all, since some may be occluded. If the estimate is right, the variance grows by
// at most 1 / (1 - this); a light that is the only one that arrives has at least its even share.
inline constexpr float EvenShare = 0.2f;

// An infinite light has the probability weight x irradiance_of() + least, unless it is hidden from the view.
struct LightChances {
    float tree;  // probability of the light tree
    float weight;
    float least;
};

inline bool is_seen(IN(Scene) scene, IN(LightSource) light, uint layers) {
    return (scene.features & FeatureLayers) == 0u || (light.layers & layers) != 0u;
}

// Whether an infinite light is sampled for a receiver: an even sky is left to BSDF samples where no cell knows its
// visible parts.
inline bool is_sampled(IN(Scene) scene, IN(View) view, IN(LightSource) light, IN(Receiver) receiver) {
    if (light.kind == LightEnvironment && receiver.sky_cell == NoSkyCell && !(light.irradiance > 0.0f))
        return false;
    return is_seen(scene, light, view.layers);
}

inline bool has_sampled_infinite_light(IN(Scene) scene, IN(View) view, IN(Receiver) receiver) {
    NO_UNROLL
    for (uint i = scene.tree_light_count; i < scene.light_count; ++i) {
        if (is_sampled(scene, view, scene.lights.items[i], receiver)) return true;
    }
    return false;
}

// Of an infinite light. Where the receiver has a cell, what the cell has seen arrive; else that of the sky is its mean
// over all directions.
inline float irradiance_of(IN(View) view, IN(LightSource) light, IN(Receiver) receiver) {
    if (light.kind == LightEnvironment && receiver.sky_cell != NoSkyCell)
        return view.sky_cells.items[receiver.sky_cell].irradiance;
    if (light.kind == LightEnvironment) return light.irradiance;
    float arriving = light.irradiance;
    if (receiver.sky_cell != NoSkyCell) arriving *= view.sky_cells.items[receiver.sky_cell].suns;
    if (receiver.normal == vec3(0.0f)) return arriving;
    return arriving * greater_of(-dot(light.direction, receiver.normal), 0.0f);
}

// Of the light tree, as irradiance_of(): of the children of its root, since the root may surround the receiver.
inline float tree_irradiance(IN(Scene) scene, IN(Receiver) receiver) {
    const uint link = scene.light_nodes.items[0].link;
    const bool has_children =
        (scene.features & FeatureLightTree) != 0u && (link & (LightLeaf | LightByPower)) == 0u;
    const uint first = has_children ? link & LightIndexBits : 0u;
    const uint count = has_children ? ((link >> LightCountShift) & 3u) + 1u : 1u;
    float sum = 0.0f;
    NO_UNROLL
    for (uint i = first; i < first + count; ++i)
        sum += expected_light(scene.light_nodes.items[i], receiver, scene.tree_scale);
    return scene.tree_intensity * sum;
}

inline LightChances light_chances(IN(Scene) scene, IN(View) view, IN(Receiver) receiver) {
    const bool has_tree = scene.tree_light_count > 0u;
    if (!has_sampled_infinite_light(scene, view, receiver))
        return LightChances(has_tree ? 1.0f : 0.0f, 0.0f, 0.0f);
    float tree = 0.0f;
    if (has_tree) tree = tree_irradiance(scene, receiver);
    float sum = tree, count = has_tree ? 1.0f : 0.0f;
    NO_UNROLL
    for (uint i = scene.tree_light_count; i < scene.light_count; ++i) {
        if (!is_sampled(scene, view, scene.lights.items[i], receiver)) continue;
        sum += irradiance_of(view, scene.lights.items[i], receiver);
        count += 1.0f;
    }
    if (!(sum > 0.0f)) return LightChances(has_tree ? 1.0f / count : 0.0f, 0.0f, 1.0f / count);
    const float weight = (1.0f - EvenShare) / sum, least = EvenShare / count;
    return LightChances(has_tree ? weight * tree + least : 0.0f, weight, least);
}

inline float chance_of(IN(LightChances) chances, IN(View) view, IN(LightSource) light,
                       IN(Receiver) receiver) {
    return chances.weight * irradiance_of(view, light, receiver) + chances.least;
}

// Probability of the light tree.
inline float tree_chance(IN(Scene) scene, IN(View) view, IN(Receiver) receiver) {
    return light_chances(scene, view, receiver).tree;
}

// Of an infinite light that the view sees.
inline float distant_chance(IN(Scene) scene, IN(View) view, IN(LightSource) light, IN(Receiver) receiver) {
    return chance_of(light_chances(scene, view, receiver), view, light, receiver);
}

// Index of the light, in the order of the scene's lights; any index below tree_light_count is the light tree.
struct ChosenLight {
    uint index;
    float probability;  // 0: there is none
    float rest;         // u rescaled to [0, 1), for the tree
};

inline ChosenLight choose_light(IN(Scene) scene, IN(View) view, IN(Receiver) receiver, float u) {
    const LightChances chances = light_chances(scene, view, receiver);
    ChosenLight chosen = ChosenLight(0u, chances.tree, 0.0f);
    if (u < chances.tree) {
        chosen.rest = lesser_of(u / chances.tree, 0.99999994f);
        return chosen;
    }
    chosen.probability = 0.0f;
    float left = u - chances.tree;
    NO_UNROLL
    for (uint i = scene.tree_light_count; i < scene.light_count && left >= 0.0f; ++i) {
        if (!is_sampled(scene, view, scene.lights.items[i], receiver)) continue;
        chosen.index = i;
        chosen.probability = chance_of(chances, view, scene.lights.items[i], receiver);
        left -= chosen.probability;
    }
    return chosen;
}

SHADING_END

#endif

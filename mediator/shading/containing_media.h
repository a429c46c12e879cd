#ifndef TESSERA_MEDIATOR_SHADING_CONTAINING_MEDIA_H
#define TESSERA_MEDIATOR_SHADING_CONTAINING_MEDIA_H

#include "mediator/shading/rays.h"

// The media that contain a point: up to MaxNestedMedia instances, sorted by priority, the effective one first
// (Schmidt and Budge 2002); NoInstance marks unused entries. Updated at each boundary from the side of the
// surface that is hit, so a surface hit twice at an edge counts once, and a missed one is corrected at the
// next crossing.
SHADING_BEGIN

inline uvec4 no_media() {
    return uvec4(NoInstance);
}

inline bool has_medium(IN(Scene) scene, uint instance) {
    return (scene.features & FeatureMedia) != 0u && scene.instances.items[instance].medium >= 0;
}

inline bool is_index_matched(IN(Scene) scene, uint instance) {
    if ((scene.features & FeatureIndexMatchedMedia) == 0u) return false;
    const int medium = scene.instances.items[instance].medium;
    return medium >= 0 && scene.media.items[medium].index_matched != 0u;
}

inline int priority_of(IN(Scene) scene, uint instance) {
    return scene.media.items[scene.instances.items[instance].medium].priority;
}

inline uvec4 without_medium(uvec4 containing_media, uint instance) {
    if (containing_media.x == instance)
        return uvec4(containing_media.y, containing_media.z, containing_media.w, NoInstance);
    if (containing_media.y == instance)
        return uvec4(containing_media.x, containing_media.z, containing_media.w, NoInstance);
    if (containing_media.z == instance)
        return uvec4(containing_media.x, containing_media.y, containing_media.w, NoInstance);
    if (containing_media.w == instance)
        return uvec4(containing_media.x, containing_media.y, containing_media.z, NoInstance);
    return containing_media;
}

inline bool precedes(IN(Scene) scene, int priority, uint other) {
    return other == NoInstance || priority >= priority_of(scene, other);
}

inline uvec4 with_medium(IN(Scene) scene, uvec4 containing_media, uint instance) {
    const uvec4 others = without_medium(containing_media, instance);
    const int priority = priority_of(scene, instance);
    if (precedes(scene, priority, others.x)) return uvec4(instance, others.x, others.y, others.z);
    if (precedes(scene, priority, others.y)) return uvec4(others.x, instance, others.y, others.z);
    if (precedes(scene, priority, others.z)) return uvec4(others.x, others.y, instance, others.z);
    if (precedes(scene, priority, others.w)) return uvec4(others.x, others.y, others.z, instance);
    return containing_media;
}

inline uvec4 after_crossing(IN(Scene) scene, uvec4 containing_media, uint instance, bool enters) {
    if (enters) return with_medium(scene, containing_media, instance);
    return without_medium(containing_media, instance);
}

inline bool contains_medium(uvec4 containing_media, uint instance) {
    return containing_media.x == instance || containing_media.y == instance ||
           containing_media.z == instance || containing_media.w == instance;
}

// Index of refraction of the first medium that defines one; 1 (air) if none does.
inline float index_of_refraction_in(IN(Scene) scene, uvec4 containing_media) {
    NO_UNROLL
    for (int i = 0; i < int(MaxNestedMedia); ++i) {
        const uint instance = containing_media[i];
        if (instance == NoInstance) return 1.0f;
        const float index = scene.media.items[scene.instances.items[instance].medium].index;
        if (!(index < 0.0f)) return index;
    }
    return 1.0f;
}

// Index of refraction inside a boundary, relative to outside; 0: infinite. A boundary inside a medium of
// higher priority has no effect: 1 (Schmidt and Budge 2002).
inline float nested_index_of_refraction(IN(Scene) scene, uvec4 containing_media, uint instance, bool enters) {
    const bool is_within = !enters && contains_medium(containing_media, instance);
    const uvec4 within = is_within ? containing_media : with_medium(scene, containing_media, instance);
    const float inner = index_of_refraction_in(scene, within),
                outer = index_of_refraction_in(scene, without_medium(containing_media, instance));
    if (inner == outer) return 1.0f;
    return outer > 0.0f ? inner / outer : 0.0f;
}

SHADING_END

#endif

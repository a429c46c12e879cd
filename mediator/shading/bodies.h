#ifndef TESSERA_MEDIATOR_SHADING_BODIES_H
#define TESSERA_MEDIATOR_SHADING_BODIES_H

#include "mediator/shading/rays.h"

// Which bodies a place is in: instances by priority, that which fills it first (Schmidt and Budge 2002);
// NoInstance: no more. What light crosses tells, by the side of the surface that it comes to; so a surface
// that is met twice at an edge counts once, and one that was missed is forgotten at the next.
SHADING_BEGIN

inline uvec4 nowhere() {
    return uvec4(NoInstance);
}

inline bool has_body(IN(Scene) scene, uint instance) {
    return (scene.features & FeatureMedia) != 0u && scene.instances.items[instance].body >= 0;
}

inline bool is_open(IN(Scene) scene, uint instance) {
    if ((scene.features & FeatureOpenMedia) == 0u) return false;
    const int body = scene.instances.items[instance].body;
    return body >= 0 && scene.bodies.items[body].open != 0u;
}

inline int priority_of(IN(Scene) scene, uint instance) {
    return scene.bodies.items[scene.instances.items[instance].body].priority;
}

inline uvec4 left(uvec4 inside, uint instance) {
    if (inside.x == instance) return uvec4(inside.y, inside.z, inside.w, NoInstance);
    if (inside.y == instance) return uvec4(inside.x, inside.z, inside.w, NoInstance);
    if (inside.z == instance) return uvec4(inside.x, inside.y, inside.w, NoInstance);
    if (inside.w == instance) return uvec4(inside.x, inside.y, inside.z, NoInstance);
    return inside;
}

inline bool goes_before(IN(Scene) scene, int priority, uint other) {
    return other == NoInstance || priority >= priority_of(scene, other);
}

inline uvec4 entered(IN(Scene) scene, uvec4 inside, uint instance) {
    const uvec4 others = left(inside, instance);
    const int priority = priority_of(scene, instance);
    if (goes_before(scene, priority, others.x)) return uvec4(instance, others.x, others.y, others.z);
    if (goes_before(scene, priority, others.y)) return uvec4(others.x, instance, others.y, others.z);
    if (goes_before(scene, priority, others.z)) return uvec4(others.x, others.y, instance, others.z);
    if (goes_before(scene, priority, others.w)) return uvec4(others.x, others.y, others.z, instance);
    return inside;
}

inline uvec4 crossed(IN(Scene) scene, uvec4 inside, uint instance, bool enters) {
    if (enters) return entered(scene, inside, instance);
    return left(inside, instance);
}

inline bool is_among(uvec4 inside, uint instance) {
    return inside.x == instance || inside.y == instance || inside.z == instance || inside.w == instance;
}

// Of the body that fills a place and has an index of refraction of its own, or of air.
inline float index_in(IN(Scene) scene, uvec4 inside) {
    KEEP_LOOP
    for (int i = 0; i < int(MaxBodies); ++i) {
        const uint instance = inside[i];
        if (instance == NoInstance) return 1.0f;
        const float index = scene.bodies.items[scene.instances.items[instance].body].index;
        if (!(index < 0.0f)) return index;
    }
    return 1.0f;
}

// What a body's index of refraction is relative to what is on the other side of its boundary; 0: without
// bound. Where the boundary lies in a body that goes before, there is no difference, and it does nothing to
// light (Schmidt and Budge 2002).
inline float nested_index(IN(Scene) scene, uvec4 inside, uint instance, bool enters) {
    const bool is_within = !enters && is_among(inside, instance);
    const uvec4 within = is_within ? inside : entered(scene, inside, instance);
    const float inner = index_in(scene, within), outer = index_in(scene, left(inside, instance));
    if (inner == outer) return 1.0f;
    return outer > 0.0f ? inner / outer : 0.0f;
}

SHADING_END

#endif

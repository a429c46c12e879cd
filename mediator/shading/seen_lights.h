#ifndef TESSERA_MEDIATOR_SHADING_SEEN_LIGHTS_H
#define TESSERA_MEDIATOR_SHADING_SEEN_LIGHTS_H

#include "mediator/shading/transport.h"

// Lights that a ray passes through: those of the tree that have a shape and stop no ray.
SHADING_BEGIN

// Whether a ray may meet a node's ball before `far`. With a margin for the rounding of what is far away.
inline bool meets_ball(IN(Scene) scene, IN(LightNode) node, IN(Ray) ray, float far) {
    const vec3 way = (node.middle - ray.origin) * scene.tree_scale;
    const float along = dot(way, ray.direction);
    const vec3 across = way - along * ray.direction;
    const float radius = node.radius * scene.tree_scale + 1e-6f * largest(abs(way));
    return dot(across, across) <= radius * radius && along + radius > 0.0f &&
           along - radius < far * scene.tree_scale;
}

// The next node, once all below `at` is done; 0 after the last.
inline uint next_light_node(IN(Scene) scene, uint at) {
    KEEP_LOOP
    while (at != 0u) {
        const uint parent = scene.light_nodes.items[at].parent;
        const uint link = scene.light_nodes.items[parent].link;
        if (at < (link & LightIndexBits) + ((link >> LightCountShift) & 3u)) return at + 1u;
        at = parent;
    }
    return 0u;
}

WITH_CONTEXT inline void add_shape(IN(Context) context, INOUT(Path) path, IN(Ray) ray, float near, float far,
                                   IN(Emitter) emitter, IN(LightSource) light) {
    if (!is_seen(context.scene, light, context.view.layers)) return;
    const ShapeHit hit =
        light.kind == LightSphere ? hit_sphere(light, ray) : hit_quad(light, emitter.inverse_root_area, ray);
    if (!hit.is_hit || !(hit.distance > near) || !(hit.distance < far)) return;
    connect_light(path.found, context.view, path.probability * light.intensity);
    float other = 0.0f;
    if (path.bsdf_pdf > 0.0f) {
        const Receiver receiver = Receiver(path.last_position, path.last_normal, vec3(0.0f));
        other = context.scene.tree_probability * leaf_probability(context.scene, emitter.node, receiver) *
                hit.pdf;
    }
    const float weight = weight_by_chance(context.view, path, other);
    vec3 arriving = path.throughput * light.intensity * weight;
    if ((context.scene.features & FeatureMedia) != 0u) {
        arriving *= transmittance(context.scene, path.inside, ray.origin + near * ray.direction,
                                  ray.direction, hit.distance - near, context.time);
    }
    add_light(path.found, context.view, arriving, path.way);
    tell_emission(context, light.intensity, ray.direction);
}

// What shines on the way of a ray, from `near` up to `far`.
WITH_CONTEXT inline void add_shapes(IN(Context) context, INOUT(Path) path, IN(Ray) ray, float near,
                                    float far) {
    if ((context.scene.features & FeatureShapedLights) == 0u) return;
    uint at = 0u;
    KEEP_LOOP
    do {
        const LightNode node = context.scene.light_nodes.items[at];
        const bool is_met = (node.link & LightShaped) != 0u && meets_ball(context.scene, node, ray, far);
        if (is_met && (node.link & LightLeaf) == 0u) {
            at = node.link & LightIndexBits;
            continue;
        }
        if (is_met) {
            const Emitter emitter = context.scene.emitters.items[node.link & LightIndexBits];
            add_shape(context, path, ray, near, far, emitter,
                      light_at(context.scene, context.scene.lights.items[emitter.light], context.time));
        }
        at = next_light_node(context.scene, at);
    } while (at != 0u);
}

// Suns, of a ray that leaves the scene.
WITH_CONTEXT inline void add_suns(IN(Context) context, INOUT(Path) path, IN(Ray) ray) {
    if ((context.scene.features & FeatureSuns) == 0u) return;
    KEEP_LOOP
    for (uint i = context.scene.tree_light_count; i < context.scene.light_count; ++i) {
        const LightSource light = light_at(context.scene, context.scene.lights.items[i], context.time);
        if (light.kind != LightDirectional || !(light.cap > 0.0f)) continue;
        if (!is_seen(context.scene, light, context.view.layers)) continue;
        if (!is_in_cap(-light.direction, light.cap, ray.direction)) continue;
        connect_light(path.found, context.view, path.probability * light.intensity);
        const float weight = weight_by_chance(context.view, path, light.probability * cap_pdf(light.cap));
        add_light(path.found, context.view, path.throughput * light.intensity * weight, path.way);
        tell_emission(context, light.intensity, ray.direction);
    }
}

SHADING_END

#endif

#ifndef TESSERA_MEDIATOR_SHADING_LIGHT_INTERSECTION_H
#define TESSERA_MEDIATOR_SHADING_LIGHT_INTERSECTION_H

#include "mediator/shading/transport.h"

// Area lights that a ray passes through: sphere and quad lights of the light tree, and sun disks; none of
// them occludes.
SHADING_BEGIN

// Whether a ray may hit a node's bounding sphere before `far`, with a margin for rounding at large distances.
inline bool intersects_bounding_sphere(IN(Scene) scene, IN(LightNode) node, IN(Ray) ray, float far) {
    const vec3 offset = (node.center - ray.origin) * scene.tree_scale;
    const float along = dot(offset, ray.direction);
    const vec3 across = offset - along * ray.direction;
    const float radius = node.radius * scene.tree_scale + 1e-6f * largest(abs(offset));
    return dot(across, across) <= radius * radius && along + radius > 0.0f &&
           along - radius < far * scene.tree_scale;
}

// The next node after the subtree of `at`; 0 after the last.
inline uint next_light_node(IN(Scene) scene, uint at) {
    NO_UNROLL
    while (at != 0u) {
        const uint parent = scene.light_nodes.items[at].parent;
        const uint link = scene.light_nodes.items[parent].link;
        if (at < (link & LightIndexBits) + ((link >> LightCountShift) & 3u)) return at + 1u;
        at = parent;
    }
    return 0u;
}

WITH_CONTEXT inline void add_area_light(IN(Context) context, INOUT(Path) path, IN(Ray) ray, float near,
                                        float far, IN(Emitter) emitter, IN(LightSource) light) {
    if (!is_seen(context.scene, light, context.view.layers)) return;
    LightHit hit =
        light.kind == LightSphere ? hit_sphere(light, ray) : hit_quad(light, emitter.inverse_root_area, ray);
    if (!hit.is_hit || !(hit.distance > near) || !(hit.distance < far)) return;
    const float distance = hit.distance - near;
    connect_light(path.found, context.view, path.probability * light.intensity);
    float other = 0.0f;
    if (path.bsdf_pdf > 0.0f) {
        if ((context.scene.features & FeatureThinGlass) != 0u) {
            // The ray may start at a thin wall, but the light was sampled from the path's last vertex.
            const Ray whole = Ray(path.last_position, ray.direction);
            hit = light.kind == LightSphere ? hit_sphere(light, whole)
                                            : hit_quad(light, emitter.inverse_root_area, whole);
        }
        const Receiver receiver = last_receiver(path);
        other = tree_chance(context.scene, context.view, receiver) *
                leaf_probability(context.scene, emitter.node, receiver) * hit.pdf;
    }
    const float weight = weight_by_chance(context.view, path, other);
    vec3 arriving = path.throughput * light.intensity * weight;
    if ((context.scene.features & FeatureMedia) != 0u) {
        arriving *= transmittance(context.scene, path.containing_media, ray.origin + near * ray.direction,
                                  ray.direction, distance, context.time);
    }
    add_light(path.found, context.view, arriving, path.class_info);
    log_emission(context, light.intensity, ray.direction);
}

// Adds the light of all sphere and quad lights that a ray hits between `near` and `far`.
WITH_CONTEXT inline void add_area_lights(IN(Context) context, INOUT(Path) path, IN(Ray) ray, float near,
                                         float far) {
    if ((context.scene.features & FeatureAreaLights) == 0u) return;
    uint at = 0u;
    NO_UNROLL
    do {
        const LightNode node = context.scene.light_nodes.items[at];
        const bool is_met = (node.link & LightContainsArea) != 0u &&
                            intersects_bounding_sphere(context.scene, node, ray, far);
        if (is_met && (node.link & LightLeaf) == 0u) {
            at = node.link & LightIndexBits;
            continue;
        }
        if (is_met) {
            const Emitter emitter = context.scene.emitters.items[node.link & LightIndexBits];
            add_area_light(context, path, ray, near, far, emitter,
                           light_at(context.scene, context.scene.lights.items[emitter.light], context.time));
        }
        at = next_light_node(context.scene, at);
    } while (at != 0u);
}

// Adds the sun disks that a ray hits when it leaves the scene.
WITH_CONTEXT inline void add_sun_disks(IN(Context) context, INOUT(Path) path, IN(Ray) ray) {
    if ((context.scene.features & FeatureSunDisks) == 0u) return;
    NO_UNROLL
    for (uint i = context.scene.tree_light_count; i < context.scene.light_count; ++i) {
        const LightSource light = light_at(context.scene, context.scene.lights.items[i], context.time);
        if (light.kind != LightDirectional || !(light.one_minus_cos_half_angle > 0.0f)) continue;
        if (!is_seen(context.scene, light, context.view.layers)) continue;
        if (!is_in_cone(-light.direction, light.one_minus_cos_half_angle, ray.direction)) continue;
        connect_light(path.found, context.view, path.probability * light.intensity);
        float other = 0.0f;
        if (path.bsdf_pdf > 0.0f) {
            // By the light at shutter open, as for the choice.
            other = distant_chance(context.scene, context.view, context.scene.lights.items[i],
                                   last_receiver(path)) *
                    cone_pdf(light.one_minus_cos_half_angle);
        }
        const float weight = weight_by_chance(context.view, path, other);
        add_light(path.found, context.view, path.throughput * light.intensity * weight, path.class_info);
        log_emission(context, light.intensity, ray.direction);
    }
}

SHADING_END

#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/scaling.h"

namespace tessera::backend {

namespace {

using shading::luminance;
using std::numbers::pi;

// Infinite lights (directional, environment) and the irradiance of each on a surface that faces it.
struct DistantLights {
    std::vector<shading::LightSource> lights;
    std::vector<double> irradiances;

    void add(const shading::LightSource& light, double irradiance) {
        lights.push_back(light);
        irradiances.push_back(irradiance);
    }
};

// Where the radiance of an area light overflows, it becomes a point light.
bool is_finite(const glm::vec3& radiance) {
    return std::isfinite(radiance.x) && std::isfinite(radiance.y) && std::isfinite(radiance.z);
}

void make_spot(shading::LightSource& light, LightLeaf& leaf, const scene::Light& source) {
    light.kind = shading::LightSpot;
    light.cos_inner = std::cos(source.inner_cone_angle);
    light.cos_outer = std::cos(source.outer_cone_angle);
    leaf.axis = glm::dvec3(light.direction);
    leaf.spread = 0.0;
    leaf.emission_angle = source.outer_cone_angle;
    leaf.power *= std::max(0.5 * (1.0 - light.cos_outer), 1e-6);  // avoids 0 for very narrow cones
}

void make_sphere(shading::LightSource& light, LightLeaf& leaf, const scene::Light& source) {
    const double radius = source.radius;
    const glm::vec3 radiance(glm::dvec3(source.intensity) / (pi * radius * radius));
    if (!is_finite(radiance)) return;
    light.kind = shading::LightSphere;
    light.intensity = radiance;
    light.radius = source.radius;
    leaf.low -= radius;
    leaf.high += radius;
    leaf.is_area = true;
}

// Returns 1 / sqrt(area); 0: the area is 0 and the light emits nothing.
float make_quad(shading::LightSource& light, LightLeaf& leaf, const scene::Light& source,
                const glm::dvec3& up) {
    const glm::dvec2 half = 0.5 * glm::dvec2(source.size);
    const double area = 4.0 * half.x * half.y;
    const glm::vec3 radiance(glm::dvec3(source.intensity) / area);
    const auto inverse = static_cast<float>(1.0 / std::sqrt(area));
    if (!is_finite(radiance) || !std::isfinite(inverse)) return 0.0f;
    light.kind = shading::LightQuad;
    light.intensity = radiance;
    light.half_size = glm::vec2(half);
    const glm::dvec3 front = light.direction;
    glm::dvec3 across = glm::cross(front, up);
    if (!(glm::length(across) > 0.0))
        across = shading::frame_around(light.direction)[0];  // degenerate transform
    across = glm::normalize(across);
    light.edge_u = glm::vec3(across);
    light.edge_v = glm::vec3(glm::normalize(glm::cross(front, across)));
    const glm::dvec3 half_extent = half.x * glm::abs(across) + half.y * glm::abs(glm::dvec3(light.edge_v));
    leaf.low -= half_extent;
    leaf.high += half_extent;
    leaf.axis = front;
    leaf.spread = 0.0;
    leaf.power *= 0.25;
    leaf.is_area = true;
    return inverse;
}

// Extends a leaf to all positions of a moving light.
void extend_over_motion(LightLeaf& leaf, const SceneTables& tables, const shading::LightSource& light) {
    if (light.motion < 0) return;
    const shading::Motion& motion = tables.motions[static_cast<std::size_t>(light.motion)];
    const LightLeaf first = leaf;
    for (const shading::Affine3x4& place :
         std::span(tables.transform_keys).subspan(motion.first_key, motion.key_intervals + 1)) {
        const glm::dvec3 offset = glm::dvec3(place.translation) - glm::dvec3(light.position);
        // If it rotates, its extent may be in any direction.
        const glm::dvec3 size(glm::length(first.high - first.low) * 0.5);
        const bool rotates = place.linear != tables.transform_keys[motion.first_key].linear;
        const glm::dvec3 center = 0.5 * (first.low + first.high);
        leaf.low = glm::min(leaf.low, (rotates ? center - size : first.low) + offset);
        leaf.high = glm::max(leaf.high, (rotates ? center + size : first.high) + offset);
        if (rotates) leaf.spread = pi;
    }
}

// A light with a position becomes an emitter.
void add_local_light(SceneTables& tables, EmitterList& list, const scene::Light& source,
                     shading::LightSource light, const glm::dvec3& up) {
    LightLeaf leaf{.low = glm::dvec3(light.position),
                   .high = glm::dvec3(light.position),
                   .spread = pi,
                   .emission_angle = 0.5 * pi,
                   .power = 4.0 * pi * luminance(light.intensity),
                   .intensity = luminance(light.intensity),
                   .emitter = static_cast<std::uint32_t>(list.emitters.size())};
    light.kind = shading::LightPoint;
    float inverse_root_area = 0.0f;
    if (source.kind == scene::LightKind::Spot) make_spot(light, leaf, source);
    if (source.kind == scene::LightKind::Sphere) make_sphere(light, leaf, source);
    if (source.kind == scene::LightKind::Quad) {
        inverse_root_area = make_quad(light, leaf, source, up);
        if (inverse_root_area == 0.0f) return;
    }
    extend_over_motion(leaf, tables, light);
    if (leaf.is_area) tables.scene.features |= shading::FeatureAreaLights;
    light.first_emitter = leaf.emitter;
    list.emitters.push_back(
        {static_cast<std::uint32_t>(tables.lights.size()), 0, shading::NoLightNode, inverse_root_area});
    tables.lights.push_back(light);
    list.leaves.push_back(leaf);
}

// The radiance of a sun disk follows from its irradiance: E / (pi sin^2). Directions are accurate to about 1e-7, so
// angles below 1e-5 count as 0.
void make_sun_disk(SceneTables& tables, shading::LightSource& light, double angle) {
    const double sine = std::sin(angle);
    const glm::vec3 radiance(glm::dvec3(light.intensity) / (pi * sine * sine));
    if (!(angle >= 1e-5) || !is_finite(radiance)) return;
    light.intensity = radiance;
    light.one_minus_cos_half_angle = static_cast<float>(2.0 * std::sin(0.5 * angle) * std::sin(0.5 * angle));
    tables.scene.features |= shading::FeatureSunDisks;
}

void add_placed_lights(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
                       EmitterList& list, DistantLights& distant) {
    for (const PlacedLight& placed : flat_scene.lights) {
        const auto& source = *scene.find_as<scene::Light>(placed.light);
        const glm::dmat3 turn(placed.world_from_light);
        const glm::dvec3 direction = -turn[2];
        const double length = glm::length(direction);
        if (!(length > 0.0)) continue;  // degenerate transform: no direction
        const double brightness = luminance(source.intensity);
        if (!(brightness > 0.0) || !std::isfinite(brightness)) continue;
        shading::LightSource light{.intensity = source.intensity, .layers = placed.layers, .motion = -1};
        light.position = glm::vec3(glm::dvec3(placed.world_from_light[3]) - tables.render_origin);
        light.direction = glm::vec3(direction / length);
        light.motion = add_motion(tables, placed.world_from_light, placed.motion);
        tables.scene.features |= shading::FeaturePunctualLights;
        if (source.kind == scene::LightKind::Directional) {
            light.kind = shading::LightDirectional;
            make_sun_disk(tables, light, source.angle);
            distant.add(light, brightness);
        } else {
            add_local_light(tables, list, source, light, turn[1]);
        }
    }
}

void add_tree(SceneTables& tables, EmitterList& list) {
    tables.emitters = std::move(list.emitters);
    tables.light_nodes = make_light_tree(list.leaves, tables.emitters);
    tables.scene.tree_scale = 1.0f;
    if (!tables.light_nodes.empty() && tables.light_nodes[0].radius > 0.0f) {
        tables.scene.tree_scale = shading::unit_scale(tables.light_nodes[0].radius);
    }
    tables.scene.tree_light_count = static_cast<std::uint32_t>(tables.lights.size());
    if (list.leaves.size() > 1) tables.scene.features |= shading::FeatureLightTree;
}

// The tree's irradiance times the squared distance, seen from far away along the mean axis of its emitters. A one-sided
// emitter is a quarter as bright in the mean over all directions as along its axis, a two-sided one half.
double intensity_of(const std::vector<LightLeaf>& leaves) {
    double all = 0.0, one_sided = 0.0, two_sided = 0.0;
    glm::dvec3 one_axis(0.0), two_axis(0.0);
    for (const LightLeaf& leaf : leaves) {
        if (leaf.spread >= pi) {
            all += leaf.intensity;
        } else if (leaf.two_sided) {
            two_sided += leaf.intensity;
            two_axis += (glm::dot(two_axis, leaf.axis) < 0.0 ? -leaf.intensity : leaf.intensity) * leaf.axis;
        } else {
            one_sided += leaf.intensity;
            one_axis += leaf.intensity * leaf.axis;
        }
    }
    return all + 0.25 * one_sided + 0.75 * glm::length(one_axis) + 0.5 * (two_sided + glm::length(two_axis));
}

// Relative to their sum at a distance of the tree's extent. Where that is 0 or overflows, only the sky is weighed.
void weigh_lights(SceneTables& tables, const EmitterList& list, const DistantLights& distant) {
    const double scale = tables.scene.tree_scale;
    const double tree = list.leaves.empty() ? 0.0 : intensity_of(list.leaves) * scale * scale;
    double total = tree;
    for (const double irradiance : distant.irradiances) total += irradiance;
    const auto weight = [&](double value) {
        return total > 0.0 && std::isfinite(total) ? static_cast<float>(value / total) : 0.0f;
    };
    tables.scene.environment.irradiance_unit = total > 0.0 ? weight(pi) : 1.0f;
    if (!list.leaves.empty())
        tables.scene.tree_intensity = weight(tree / double(tables.light_nodes[0].power));
    for (std::size_t i = 0; i < distant.lights.size(); ++i) {
        tables.lights.push_back(distant.lights[i]);
        tables.lights.back().irradiance = weight(distant.irradiances[i]);
    }
}

}  // namespace

void add_lights(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene) {
    EmitterList list;
    DistantLights distant;
    add_mesh_lights(tables, list);
    add_placed_lights(tables, scene, flat_scene, list, distant);
    add_tree(tables, list);
    if (tables.sky.luminance > 0.0) {
        distant.add({.kind = shading::LightEnvironment, .layers = shading::AllLayers, .motion = -1},
                    pi * tables.sky.excess);
    }
    weigh_lights(tables, list, distant);
    tables.scene.light_count = static_cast<std::uint32_t>(tables.lights.size());
    tables.scene.environment_light = tables.sky.luminance > 0.0 ? int(tables.lights.size()) - 1 : -1;
}

}  // namespace tessera::backend

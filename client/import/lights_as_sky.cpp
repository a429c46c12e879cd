#include "client/import/lights_as_sky.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>
#include <set>

namespace tessera::import {
namespace {

constexpr double Pi = std::numbers::pi;

// Mean of 1 / distance^2 from a light at `distance` from its center over a ball.
double mean_inverse_square(double distance, double radius) {
    if (distance == 0.0 && radius == 0.0) return 0.0;
    if (!(distance < 1e3 * radius)) return 1.0 / (distance * distance);  // the formula would cancel
    const double sum = distance + radius, difference = std::abs(radius - distance);
    const double logarithm = difference > 0.0 && distance > 0.0 ? std::log(sum / difference) : 0.0;
    const double across =
        distance < 1e-3 * radius ? 2.0 * radius : sum * (radius - distance) / distance * logarithm;
    return 0.75 * (2.0 * radius + across) / (radius * radius * radius);
}

// Mean over all directions of what the light sends, relative to its intensity.
double share_of_directions(const scene::Light& light) {
    const double inner = std::cos(double(light.inner_cone_angle)),
                 outer = std::cos(double(light.outer_cone_angle));
    switch (light.kind) {
        case scene::LightKind::Spot:
            return 0.5 * ((1.0 - inner) + (inner - outer) / 3.0);
        case scene::LightKind::Quad:
            return 0.25;
        default:
            return 1.0;
    }
}

// By name or by the file's mark.
std::set<ObjectId> chosen_lights(SceneBuilder& builder, const SceneStats& stats) {
    const ImportOptions& options = builder.options();
    std::set<ObjectId> chosen;
    if (options.soft_lights_as_sky) chosen = builder.soft_lights();
    if (options.soft_lights_as_sky && chosen.empty())
        builder.notice("no light of it is marked as casting no hard shadow: all are kept");
    std::set<std::string> wanted(options.lights_as_sky.begin(), options.lights_as_sky.end()), names;
    for (const LightInstance& light : stats.lights) {
        const std::string& name = builder.get<scene::Light>(light.id).name;
        names.insert(name);
        if (wanted.contains(name)) chosen.insert(light.id);
    }
    for (const std::string& name : wanted) {
        if (names.contains(name)) continue;
        std::string text = "there is no light '" + name + "' to leave out";
        for (const std::string& known : names)
            text += (&known == &*names.begin() ? ": the lights are " : ", ") + known;
        throw Error(ErrorCode::InvalidInput, text);
    }
    return chosen;
}

}  // namespace

glm::dvec3 radiance_as_sky(const scene::Light& light, const glm::dmat4& world, const Bounds& bounds) {
    const glm::dvec3 facing = glm::dvec3(light.intensity) / (4.0 * Pi);
    if (light.kind == scene::LightKind::Directional) return facing;
    const glm::dvec3 center = bounds.empty() ? glm::dvec3(0.0) : 0.5 * (bounds.lower + bounds.upper);
    const double radius = bounds.empty() ? 0.0 : 0.5 * glm::length(bounds.upper - bounds.lower);
    const double distance = glm::length(glm::dvec3(world[3]) - center);
    return facing * share_of_directions(light) * mean_inverse_square(distance, radius);
}

void replace_lights_by_sky(SceneBuilder& builder, const SceneStats& stats, scene::Background& background) {
    const std::set<ObjectId> chosen = chosen_lights(builder, stats);
    glm::dvec3 radiance(0.0);
    std::uint64_t count = 0;
    for (const LightInstance& light : stats.lights) {
        if (!chosen.contains(light.id)) continue;
        ++count;
        radiance += radiance_as_sky(builder.get<scene::Light>(light.id), light.world, stats.bounds);
    }
    if (count == 0) return;
    constexpr double MaxRadiance = 1e12;  // of a background
    for (int k = 0; k < 3; ++k) {
        if (!(radiance[k] + double(background.color[k]) <= MaxRadiance))
            throw Error(
                ErrorCode::InvalidInput,
                "the lights to leave out are too bright for a sky: keep them, or correct their intensity");
    }
    for (scene::Create& entry : builder.result().objects) {
        if (auto* transform = std::get_if<scene::Transform>(&entry.object))
            std::erase_if(transform->children, [&](ObjectId child) { return chosen.contains(child); });
    }
    builder.result().counts.lights -= count;
    background.color += glm::vec3(radiance);
    char sky[96];
    std::snprintf(sky, sizeof(sky),
                  " for speed: the sky is brighter by a radiance of %.3g, %.3g, %.3g instead", radiance.x,
                  radiance.y, radiance.z);
    builder.notice((count == 1 ? "1 light is left out" : std::to_string(count) + " lights are left out") +
                   sky);
}

}  // namespace tessera::import

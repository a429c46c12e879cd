#include <algorithm>
#include <cmath>

#include "backends/embree/light_builder.h"
#include "backends/embree/scene_tables.h"
#include "mediator/shading/sampling.h"

namespace tessera::embree {

namespace {

using shading::luminance;
using shading::Pi;

// Middle of the triangle stands for its emission: only the choice of a light depends on it.
constexpr glm::vec2 Middle{1.0f / 3.0f, 1.0f / 3.0f};

LightData mesh_light(const SceneTables& tables, std::uint32_t index) {
    const InstanceData& instance = tables.instances[index];
    LightData light{.type = LightType::Mesh, .instance = index};
    std::vector<double> sums;
    double area = 0.0, flux = 0.0;
    for (std::uint32_t t = 0; t < instance.mesh->triangles.size(); ++t) {
        const glm::uvec3 corners = instance.mesh->triangles[t];
        const glm::dvec3 a = instance.to_world(instance.mesh->positions[corners.x]);
        const glm::dvec3 b = instance.to_world(instance.mesh->positions[corners.y]);
        const glm::dvec3 c = instance.to_world(instance.mesh->positions[corners.z]);
        const double triangle = 0.5 * glm::length(glm::cross(b - a, c - a));
        area += triangle;
        flux += triangle * luminance(emission_at(tables, instance, t, Middle));
        sums.push_back(area);
    }
    for (const double sum : sums) light.cumulative_area.push_back(static_cast<float>(sum / area));
    light.area = static_cast<float>(area);
    light.power = flux * double(Pi) * (tables.materials[instance.material].double_sided ? 2.0 : 1.0);
    return light;
}

LightData placed_light(const PlacedLights::Item& item, double radius) {
    LightData light{
        .position = item.position, .direction = item.direction, .intensity = item.source->intensity};
    const double brightness = luminance(item.source->intensity);
    switch (item.source->kind) {
        case scene::LightKind::Point:
            light.type = LightType::Point;
            light.power = 4.0 * double(Pi) * brightness;
            break;
        case scene::LightKind::Spot:
            light.type = LightType::Spot;
            light.cos_inner = std::cos(item.source->inner_cone_angle);
            light.cos_outer = std::cos(item.source->outer_cone_angle);
            light.power = 2.0 * double(Pi) * (1.0 - light.cos_outer) * brightness;
            break;
        case scene::LightKind::Directional:
            light.type = LightType::Directional;
            light.power = double(Pi) * radius * radius * brightness;
            break;
    }
    return light;
}

void assign_probabilities(LightTable& table) {
    double total = 0.0;
    for (const LightData& light : table.lights) total += light.power;
    constexpr double UniformShare = 0.1;
    const double uniform = 1.0 / static_cast<double>(table.lights.size());
    double sum = 0.0;
    for (LightData& light : table.lights) {
        const double by_power = total > 0.0 && std::isfinite(total) ? light.power / total : uniform;
        const double probability = (1.0 - UniformShare) * by_power + UniformShare * uniform;
        light.probability = static_cast<float>(probability);
        sum += probability;
        table.cumulative.push_back(static_cast<float>(sum));
    }
}

}  // namespace

LightTable make_lights(SceneTables& tables, const PlacedLights& placed) {
    LightTable table;
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        InstanceData& instance = tables.instances[i];
        const MaterialData& material = tables.materials[instance.material];
        if (!material.emits() || material.unlit) continue;
        LightData light = mesh_light(tables, i);
        if (!(light.area > 0.0f) || !std::isfinite(light.area)) continue;  // nothing of it can be hit
        instance.light = static_cast<std::int32_t>(table.lights.size());
        table.lights.push_back(std::move(light));
    }
    for (const PlacedLights::Item& item : placed.items) {
        if (!(luminance(item.source->intensity) > 0.0f)) continue;
        table.lights.push_back(placed_light(item, placed.scene_radius));
    }
    if (tables.environment.emits()) {
        table.environment = static_cast<std::int32_t>(table.lights.size());
        LightData light{.type = LightType::Environment};
        const double radius = placed.scene_radius;
        light.power = 4.0 * double(Pi * Pi) * radius * radius * tables.environment.mean_luminance();
        table.lights.push_back(light);
    }
    if (!table.lights.empty()) assign_probabilities(table);
    return table;
}

std::int32_t choose_light(const LightTable& table, float u) {
    if (table.lights.empty()) return -1;
    const auto above = std::upper_bound(table.cumulative.begin(), table.cumulative.end(), u);
    return static_cast<std::int32_t>(std::min<std::size_t>(
        static_cast<std::size_t>(above - table.cumulative.begin()), table.lights.size() - 1));
}

}  // namespace tessera::embree

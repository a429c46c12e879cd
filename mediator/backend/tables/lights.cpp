#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"
#include "mediator/shading/sampling.h"

namespace tessera::backend {

namespace {

using shading::luminance;
using std::numbers::pi;

// A light that is being made; its power is for the choice among them.
struct Candidate {
    shading::LightSource light{};
    double power = 0.0;
};

glm::vec3 to_world(const shading::Instance& instance, const glm::vec3& p) {
    return instance.linear * p + instance.translation;
}

// How far the scene reaches, for the power of what shines on all of it.
double radius_of(const SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes) {
    glm::dvec3 low(std::numeric_limits<double>::infinity()), high(-low);
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        const Mesh& mesh = *meshes.find(lowered.instances[i].geometry);
        if (!(mesh.low.x <= mesh.high.x)) continue;
        for (unsigned corner = 0; corner < 8; ++corner) {
            const glm::dvec3 place =
                to_world(tables.instances[i],
                         {(corner & 1u) ? mesh.low.x : mesh.high.x, (corner & 2u) ? mesh.low.y : mesh.high.y,
                          (corner & 4u) ? mesh.low.z : mesh.high.z});
            low = glm::min(low, place);
            high = glm::max(high, place);
        }
    }
    const double radius = 0.5 * glm::length(high - low);
    return radius > 0.0 && radius < std::numeric_limits<double>::infinity() ? radius : 1.0;
}

// None for what cannot be hit.
std::optional<Candidate> mesh_light(SceneTables& tables, const shading::Scene& scene, std::uint32_t index) {
    const shading::Instance& instance = tables.instances[index];
    const shading::Material& material = tables.materials[instance.material];
    const shading::Mesh& mesh = tables.meshes[instance.mesh];
    std::vector<double> areas;
    double area = 0.0, flux = 0.0;
    for (std::uint32_t t = 0; t < mesh.triangle_count; ++t) {
        const glm::uvec3 corners = mesh.triangles.items[t];
        const glm::dvec3 a = to_world(instance, mesh.positions.items[corners.x]);
        const glm::dvec3 b = to_world(instance, mesh.positions.items[corners.y]);
        const glm::dvec3 c = to_world(instance, mesh.positions.items[corners.z]);
        areas.push_back(0.5 * glm::length(glm::cross(b - a, c - a)));
        area += areas.back();
        // The middle of the triangle stands for its emission: only the choice of a light depends on it.
        flux += areas.back() *
                luminance(shading::emission_at(scene, material, mesh, corners, {1.0f / 3.0f, 1.0f / 3.0f}));
    }
    Candidate made;
    const auto inverse = static_cast<float>(1.0 / std::sqrt(area));
    if (!(inverse > 0.0f) || !std::isfinite(inverse)) return std::nullopt;
    made.light.inverse_root_area = inverse;
    made.light.kind = shading::LightMesh;
    made.light.instance = index;
    made.light.layers = instance.layers;
    made.light.area_sums = add_sums(tables, areas);
    made.power = flux * pi * (material.double_sided != 0 ? 2.0 : 1.0);
    return made;
}

Candidate placed_light(const scene::Light& source, double radius) {
    Candidate made;
    made.light.intensity = source.intensity;
    const double brightness = luminance(source.intensity);
    switch (source.kind) {
        case scene::LightKind::Point:
        case scene::LightKind::Sphere:
        case scene::LightKind::Quad:
            made.light.kind = shading::LightPoint;
            made.power = 4.0 * pi * brightness;
            break;
        case scene::LightKind::Spot:
            made.light.kind = shading::LightSpot;
            made.light.cos_inner = std::cos(source.inner_cone_angle);
            made.light.cos_outer = std::cos(source.outer_cone_angle);
            made.power = 2.0 * pi * (1.0 - made.light.cos_outer) * brightness;
            break;
        case scene::LightKind::Directional:
            made.light.kind = shading::LightDirectional;
            made.power = pi * radius * radius * brightness;
            break;
    }
    return made;
}

void add_mesh_lights(SceneTables& tables, std::vector<Candidate>& candidates) {
    const shading::Scene scene = on_host(tables);
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        const shading::Material& material = tables.materials[tables.instances[i].material];
        if (!shading::emits(material) || material.unlit != 0) continue;
        const std::optional<Candidate> made = mesh_light(tables, scene, i);
        if (!made) continue;
        tables.instances[i].light = static_cast<std::int32_t>(candidates.size());
        candidates.push_back(*made);
        tables.scene.features |= shading::FeatureMeshLights;
    }
}

void add_placed_lights(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered, double radius,
                       std::vector<Candidate>& candidates) {
    for (const PlacedLight& placed : lowered.lights) {
        const auto& source = *scene.find_as<scene::Light>(placed.light);
        const glm::dvec3 shines = glm::dmat3(placed.world_from_light) * glm::dvec3(0.0, 0.0, -1.0);
        const double length = glm::length(shines);
        if (!(length > 0.0)) continue;  // flattened: it has no direction
        if (!(luminance(source.intensity) > 0.0f)) continue;
        Candidate made = placed_light(source, radius);
        made.light.position = glm::vec3(glm::dvec3(placed.world_from_light[3]) - tables.render_origin);
        made.light.direction = glm::vec3(shines / length);
        made.light.layers = placed.layers;
        candidates.push_back(made);
        tables.scene.features |= shading::FeaturePlacedLights;
    }
}

void assign_probabilities(SceneTables& tables, std::vector<Candidate>& candidates) {
    double total = 0.0, sum = 0.0;
    for (const Candidate& candidate : candidates) total += candidate.power;
    constexpr double UniformShare = 0.1;
    const double uniform = 1.0 / static_cast<double>(candidates.size());
    tables.scene.light_sums = static_cast<std::uint32_t>(tables.sums.size());
    for (Candidate& candidate : candidates) {
        const double by_power = total > 0.0 && std::isfinite(total) ? candidate.power / total : uniform;
        const double probability = (1.0 - UniformShare) * by_power + UniformShare * uniform;
        candidate.light.probability = static_cast<float>(probability);
        sum += probability;
        tables.sums.push_back(static_cast<float>(sum));
        tables.lights.push_back(candidate.light);
    }
}

}  // namespace

void add_lights(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                const MeshCatalog& meshes, double sky_luminance) {
    std::vector<Candidate> candidates;
    add_mesh_lights(tables, candidates);
    const double radius = radius_of(tables, lowered, meshes);
    add_placed_lights(tables, scene, lowered, radius, candidates);
    tables.scene.environment_light = -1;
    if (sky_luminance > 0.0) {
        tables.scene.environment_light = static_cast<std::int32_t>(candidates.size());
        Candidate sky{.power = 4.0 * pi * pi * radius * radius * sky_luminance};
        sky.light.kind = shading::LightEnvironment;
        sky.light.layers = shading::AllLayers;
        candidates.push_back(sky);
    }
    assign_probabilities(tables, candidates);
    tables.scene.light_count = static_cast<std::uint32_t>(tables.lights.size());
}

}  // namespace tessera::backend

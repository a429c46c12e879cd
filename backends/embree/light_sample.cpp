#include "backends/embree/light_sample.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tessera::embree {

namespace {

// glTF's falloff between the cones (KHR_lights_punctual).
float spot_falloff(const LightData& light, const glm::vec3& to_light) {
    const float cosine = -glm::dot(light.direction, to_light);
    if (!(cosine > light.cos_outer)) return 0.0f;
    if (cosine >= light.cos_inner) return 1.0f;
    const float t = (cosine - light.cos_outer) / (light.cos_inner - light.cos_outer);
    return t * t;
}

LightSample sample_point(const LightData& light, const Surface& surface) {
    LightSample sample{.delta = true};
    const glm::vec3 offset = light.position - surface.position;
    const float distance2 = glm::dot(offset, offset);
    if (!(distance2 > 0.0f)) return sample;
    sample.direction = offset / std::sqrt(distance2);
    sample.radiance = light.intensity / distance2;
    sample.intensity = light.intensity;
    if (light.type == LightType::Spot) {
        const float falloff = spot_falloff(light, sample.direction);
        sample.radiance *= falloff;
        sample.intensity *= falloff;
    }
    sample.pdf = light.probability;
    sample.origin =
        leave_surface({surface.position, surface.error}, surface.geometric_normal, sample.direction);
    sample.segment = light.position - sample.origin;
    return sample;
}

LightSample sample_distant(const LightData& light, const Surface& surface, const glm::vec3& direction) {
    LightSample sample{.direction = direction, .pdf = light.probability};
    sample.origin = leave_surface({surface.position, surface.error}, surface.geometric_normal, direction);
    sample.segment = direction;
    sample.far = std::numeric_limits<float>::infinity();
    return sample;
}

// Cosine on the light and squared distance to density per solid angle. Double: the product of squares of tiny
// or huge scenes leaves the range of floats.
float solid_angle_pdf(float probability, float area, double distance2, double cosine) {
    return static_cast<float>(static_cast<double>(probability) * distance2 /
                              (std::max(cosine, 1e-30) * static_cast<double>(area)));
}

struct TriangleChoice {
    std::uint32_t triangle;
    float u;  // stretched back to the unit interval
};

TriangleChoice choose_triangle(const LightData& light, float u) {
    const auto& sums = light.cumulative_area;
    auto index = static_cast<std::size_t>(std::upper_bound(sums.begin(), sums.end(), u) - sums.begin());
    index = std::min(index, sums.size() - 1);
    const float low = index == 0 ? 0.0f : sums[index - 1];
    const float width = sums[index] - low;
    const float rest = width > 0.0f ? (u - low) / width : 0.5f;
    return {static_cast<std::uint32_t>(index), std::clamp(rest, 0.0f, 0.99999994f)};
}

LightSample sample_mesh(const SceneTables& tables, const LightData& light, const Surface& surface,
                        const glm::vec2& u) {
    LightSample sample;
    const InstanceData& instance = tables.instances[light.instance];
    const TriangleChoice chosen = choose_triangle(light, u.x);
    const glm::vec2 barycentric = shading::sample_triangle({chosen.u, u.y});
    PointWithError point = point_on(instance, chosen.triangle, barycentric);
    const glm::vec3 offset = point.position - surface.position;
    const double distance2 = glm::dot(glm::dvec3(offset), glm::dvec3(offset));
    if (!(distance2 > 0.0)) return sample;
    sample.direction = glm::vec3(glm::dvec3(offset) / std::sqrt(distance2));

    const glm::uvec3 corners = instance.mesh->triangles[chosen.triangle];
    const auto& p = instance.mesh->positions;
    const glm::dvec3 normal =
        glm::dmat3(instance.normals) * glm::cross(glm::dvec3(p[corners.y]) - glm::dvec3(p[corners.x]),
                                                  glm::dvec3(p[corners.z]) - glm::dvec3(p[corners.x]));
    const double length = glm::length(normal);
    if (!(length > 0.0)) return sample;
    const double facing = -glm::dot(normal / length, glm::dvec3(sample.direction));
    const MaterialData& material = tables.materials[instance.material];
    if (facing == 0.0 || (facing < 0.0 && !material.double_sided)) return sample;
    sample.radiance = emission_at(tables, instance, chosen.triangle, barycentric);
    if (material.alpha_mode != scene::AlphaMode::Opaque) {
        // A ray that comes by chance stops here with this probability (alpha_filter).
        const float alpha = alpha_at(tables, instance, chosen.triangle, barycentric);
        const bool masked = material.alpha_mode == scene::AlphaMode::Mask;
        sample.radiance *=
            masked ? (alpha >= material.alpha_cutoff ? 1.0f : 0.0f) : std::clamp(alpha, 0.0f, 1.0f);
    }
    sample.intensity = sample.radiance;
    sample.pdf = solid_angle_pdf(light.probability, light.area, distance2, std::fabs(facing));
    sample.origin =
        leave_surface({surface.position, surface.error}, surface.geometric_normal, sample.direction);
    // The far end leaves its own surface too, by its own error and that of the segment's rounding on the way
    // there.
    point.error += 2.0f * 0x1p-24f * glm::abs(offset);
    const glm::vec3 target = leave_surface(point, glm::vec3(normal / length), -sample.direction);
    sample.segment = target - sample.origin;
    return sample;
}

}  // namespace

LightSample sample_light(const SceneTables& tables, const Surface& surface, float choice,
                         const glm::vec2& u) {
    const std::int32_t index = choose_light(tables.lights, choice);
    if (index < 0) return {};
    const LightData& light = tables.lights.lights[static_cast<std::size_t>(index)];
    switch (light.type) {
        case LightType::Point:
        case LightType::Spot:
            return sample_point(light, surface);
        case LightType::Directional: {
            LightSample sample = sample_distant(light, surface, -light.direction);
            sample.radiance = sample.intensity = light.intensity;
            sample.delta = true;
            return sample;
        }
        case LightType::Mesh:
            return sample_mesh(tables, light, surface, u);
        case LightType::Environment: {
            const Environment::Sample sky = tables.environment.sample(u);
            LightSample sample = sample_distant(light, surface, sky.direction);
            sample.radiance = sample.intensity = tables.environment.radiance(sky.direction);
            sample.pdf *= sky.pdf;
            return sample;
        }
    }
    return {};
}

float mesh_light_pdf(const SceneTables& tables, const Surface& light_surface, const glm::vec3& from) {
    const std::int32_t index = light_surface.instance->light;
    if (index < 0) return 0.0f;
    const LightData& light = tables.lights.lights[static_cast<std::size_t>(index)];
    const glm::dvec3 offset = glm::dvec3(light_surface.position) - glm::dvec3(from);
    const double distance2 = glm::dot(offset, offset);
    if (!(distance2 > 0.0)) return 0.0f;
    const double cosine =
        std::fabs(glm::dot(glm::dvec3(light_surface.geometric_normal), offset / std::sqrt(distance2)));
    return solid_angle_pdf(light.probability, light.area, distance2, cosine);
}

float environment_pdf(const SceneTables& tables, const glm::vec3& direction) {
    if (tables.lights.environment < 0) return 0.0f;
    const LightData& light = tables.lights.lights[static_cast<std::size_t>(tables.lights.environment)];
    return light.probability * tables.environment.pdf(direction);
}

}  // namespace tessera::embree

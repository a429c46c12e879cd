// The triangles of glowing meshes, as emitters.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"
#include "mediator/shading/points.h"
#include "mediator/shading/sampling.h"

namespace tessera::backend {

namespace {

using shading::luminance;
using std::numbers::pi;

glm::vec3 to_world(const shading::Instance& instance, const glm::vec3& p) {
    return instance.linear * p + instance.translation;
}

// Luminance that is 0 where it is none.
double brightness(const glm::vec3& emission) {
    const double value = luminance(emission);
    return value > 0.0 && std::isfinite(value) ? value : 0.0;
}

// The most that a material can shine with.
double brightest(const shading::Scene& scene, const shading::Material& material) {
    if (!shading::is_used(scene, material.emission_texture)) return brightness(material.emission);
    const shading::Texture& map = scene.textures.items[material.emission_texture.texture];
    double most = 0.0;
    for (std::uint32_t i = 0; i < map.width * map.height; ++i) {
        most = std::max(most, brightness(material.emission * glm::vec3(shading::texel_at(scene, map, i))));
    }
    return most;
}

// A mesh that glows, and how.
struct Glow {
    const shading::Scene& scene;
    const shading::Material& material;
    const shading::Mesh& mesh;
    double most;  // luminance

    // Of a triangle in the mean, seen at places of a grid about as fine as its texels, which may miss what is
    // smaller: it is never less than a hundredth of the most, so that it is tried from time to time.
    double mean(const glm::uvec3& corners) const {
        if (!shading::is_used(scene, material.emission_texture)) return most;
        const unsigned n = steps(corners);
        double sum = 0.0;
        // The triangle in n^2 like it; those that stand on their heads lie between the others.
        for (unsigned row = 0; row < n; ++row) {
            for (unsigned i = 0; i < 2 * (n - row) - 1; ++i) {
                const float shift = i % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
                const glm::vec2 b =
                    (glm::vec2(float(i / 2), float(row)) + glm::vec2(shift)) / static_cast<float>(n);
                sum += brightness(shading::emission_at(scene, material, mesh, corners, b));
            }
        }
        return std::max(sum / (double(n) * n), 0.01 * most);
    }

  private:
    static constexpr double MostSteps = 16.0;

    unsigned steps(const glm::uvec3& corners) const {
        const shading::TextureUse& use = material.emission_texture;
        const shading::Texture& map = scene.textures.items[use.texture];
        const auto texel = [&](glm::vec2 b) {
            const glm::dvec2 uv = shading::tex_coord_at(mesh, use.set, corners, b);
            return glm::dvec2(glm::dot(glm::dvec2(use.row_u), uv) * map.width,
                              glm::dot(glm::dvec2(use.row_v), uv) * map.height);
        };
        const glm::dvec2 a = texel({0, 0}), b = texel({1, 0}), c = texel({0, 1});
        const double longest = std::max({glm::length(b - a), glm::length(c - a), glm::length(c - b)});
        return static_cast<unsigned>(std::clamp(longest, 2.0, MostSteps));
    }
};

// One of an instance's triangles; its leaf where it shines.
void add_triangle(EmitterList& list, const Glow& glow, const shading::Instance& instance, std::uint32_t light,
                  std::uint32_t triangle) {
    const glm::uvec3 corners = glow.mesh.triangles.items[triangle];
    const glm::dvec3 a = to_world(instance, glow.mesh.positions.items[corners.x]);
    const glm::dvec3 b = to_world(instance, glow.mesh.positions.items[corners.y]);
    const glm::dvec3 c = to_world(instance, glow.mesh.positions.items[corners.z]);
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const double area = 0.5 * glm::length(normal);
    const auto inverse = static_cast<float>(1.0 / std::sqrt(area));
    const auto index = static_cast<std::uint32_t>(list.emitters.size());
    list.emitters.push_back({light, triangle, shading::NoLightNode, inverse});
    if (!(inverse > 0.0f) || !std::isfinite(inverse)) return;  // it cannot be hit
    const double sides = glow.material.double_sided != 0 ? 2.0 : 1.0;
    const double power = area * glow.mean(corners) * pi * sides;
    if (!(power > 0.0) || !std::isfinite(power)) return;
    // The side that the shading takes for the front, whichever way a mirrored instance turns the corners.
    const shading::Triangle face = shading::triangle_of(glow.mesh, corners);
    const glm::dvec3 front = shading::face_normal(instance, face, glm::vec3(0.0f));
    const bool has_front = front != glm::dvec3(0.0);
    list.leaves.push_back({.low = glm::min(a, glm::min(b, c)),
                           .high = glm::max(a, glm::max(b, c)),
                           .axis = front,
                           .spread = has_front ? 0.0 : pi,
                           .reach = 0.5 * pi,
                           .power = power,
                           .emitter = index,
                           .two_sided = has_front && glow.material.double_sided != 0});
}

}  // namespace

void add_mesh_lights(SceneTables& tables, EmitterList& list) {
    const shading::Scene scene = on_host(tables);
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        shading::Instance& instance = tables.instances[i];
        const shading::Material& material = tables.materials[instance.material];
        if (!shading::emits(material) || material.unlit != 0 || instance.light == shading::ShadowCatcher)
            continue;
        const Glow glow{scene, material, tables.meshes[instance.mesh], brightest(scene, material)};
        const std::size_t emitters = list.emitters.size(), leaves = list.leaves.size();
        const auto index = static_cast<std::uint32_t>(tables.lights.size());
        for (std::uint32_t t = 0; t < glow.mesh.triangle_count; ++t) {
            add_triangle(list, glow, instance, index, t);
        }
        if (list.leaves.size() == leaves) {  // nothing of it shines, or can be hit
            list.emitters.resize(emitters);
            continue;
        }
        instance.light = static_cast<std::int32_t>(index);
        tables.lights.push_back({.kind = shading::LightMesh,
                                 .instance = i,
                                 .first_emitter = static_cast<std::uint32_t>(emitters),
                                 .layers = instance.layers});
        tables.scene.features |= shading::FeatureMeshLights;
    }
}

}  // namespace tessera::backend

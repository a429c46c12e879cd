// The triangles of glowing meshes, as emitters.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"
#include "mediator/shading/points.h"
#include "mediator/shading/sampling.h"

namespace tessera::backend {

namespace {

using shading::luminance;
using std::numbers::pi;

// An instance and its mesh as they are at the steps of their motion.
struct Shape {
    std::vector<shading::Place> places;
    std::vector<shading::Mesh> meshes;
    bool turns = false;  // its triangles: they have other directions or areas from time to time

    Shape(const SceneTables& tables, const shading::Instance& instance, const shading::Mesh& mesh)
        : places(places_of(tables, instance)), meshes{mesh} {
        meshes.front().arrays &= ~shading::MeshBends;
        for (std::uint32_t step = 1; (mesh.arrays & shading::MeshBends) != 0 && step <= mesh.steps; ++step) {
            meshes.push_back(meshes.front());
            meshes.back().positions = tables.mesh_steps[mesh.first_step + step].positions;
        }
        turns = meshes.size() > 1;
        for (const shading::Place& place : places) turns = turns || place.linear != places.front().linear;
    }
};

// Of a triangle at all times: between steps it stays within the hull.
struct Reach {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-low};
    double area = 0.0;  // at the steps, in the mean

    Reach(const Shape& shape, const glm::uvec3& corners) {
        for (const shading::Place& place : shape.places) {
            for (const shading::Mesh& mesh : shape.meshes) {
                const shading::Triangle t = shading::triangle_of(mesh, corners);
                const auto to_world = [&](const glm::vec3& p) {
                    return glm::dvec3(place.linear * p + place.translation);
                };
                const std::array world{to_world(t.p), to_world(t.q), to_world(t.r)};
                for (const glm::dvec3& corner : world) {
                    low = glm::min(low, corner);
                    high = glm::max(high, corner);
                }
                area += 0.5 * glm::length(glm::cross(world[1] - world[0], world[2] - world[0]));
            }
        }
        area /= static_cast<double>(shape.places.size() * shape.meshes.size());
    }
};

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
                const unsigned column = i / 2;
                const glm::vec2 b =
                    (glm::vec2(float(column), float(row)) + glm::vec2(shift)) / static_cast<float>(n);
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
void add_triangle(EmitterList& list, const Glow& glow, const Shape& shape, const shading::Instance& instance,
                  std::uint32_t light, std::uint32_t triangle) {
    const glm::uvec3 corners = glow.mesh.triangles.items[triangle];
    const Reach reach(shape, corners);
    const double area = reach.area;
    const auto inverse = static_cast<float>(1.0 / std::sqrt(area));
    const auto index = static_cast<std::uint32_t>(list.emitters.size());
    list.emitters.push_back({light, triangle, shading::NoLightNode, shape.turns ? 0.0f : inverse});
    if (!(inverse > 0.0f) || !std::isfinite(inverse)) return;  // it cannot be hit
    const double sides = glow.material.double_sided != 0 ? 2.0 : 1.0;
    const double power = area * glow.mean(corners) * pi * sides;
    if (!(power > 0.0) || !std::isfinite(power)) return;
    // The side that the shading takes for the front, whichever way a mirrored instance turns the corners.
    const shading::Triangle face = shading::triangle_of(glow.mesh, corners);
    const glm::dvec3 front = shading::face_normal(instance, face, glm::vec3(0.0f));
    const bool has_front = front != glm::dvec3(0.0) && !shape.turns;
    list.leaves.push_back({.low = reach.low,
                           .high = reach.high,
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
        const Shape shape(tables, instance, tables.meshes[instance.mesh]);
        const Glow glow{scene, material, shape.meshes.front(), brightest(scene, material)};
        const std::size_t emitters = list.emitters.size(), leaves = list.leaves.size();
        const auto index = static_cast<std::uint32_t>(tables.lights.size());
        for (std::uint32_t t = 0; t < glow.mesh.triangle_count; ++t) {
            add_triangle(list, glow, shape, instance, index, t);
        }
        if (list.leaves.size() == leaves) {  // nothing of it shines, or can be hit
            list.emitters.resize(emitters);
            continue;
        }
        instance.light = static_cast<std::int32_t>(index);
        tables.lights.push_back({.kind = shading::LightMesh,
                                 .instance = i,
                                 .first_emitter = static_cast<std::uint32_t>(emitters),
                                 .layers = instance.layers,
                                 .motion = -1});
        tables.scene.features |= shading::FeatureMeshLights;
    }
}

}  // namespace tessera::backend

// The triangles of emissive meshes, as emitters.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/materials.h"
#include "mediator/shading/sampling.h"
#include "mediator/shading/triangle_points.h"

namespace tessera::backend {

namespace {

using shading::luminance;
using std::numbers::pi;

// The motion keys of an instance and of its mesh.
struct ShapeKeys {
    std::vector<shading::Affine3x4> transforms;
    std::vector<shading::Mesh> meshes;
    bool deforms = false;  // whether normals or areas of its triangles change over time

    ShapeKeys(const SceneTables& tables, const shading::Instance& instance, const shading::Mesh& mesh)
        : transforms(transform_keys_of(tables, instance)), meshes{mesh} {
        meshes.front().arrays &= ~shading::MeshDeforms;
        for (std::uint32_t step = 1; (mesh.arrays & shading::MeshDeforms) != 0 && step <= mesh.key_intervals;
             ++step) {
            meshes.push_back(meshes.front());
            meshes.back().positions = tables.mesh_keys[mesh.first_key + step].positions;
        }
        deforms = meshes.size() > 1;
        for (const shading::Affine3x4& place : transforms)
            deforms = deforms || place.linear != transforms.front().linear;
    }
};

// Bounds of a triangle over the shutter: between keys it stays in their convex hull.
struct TriangleExtent {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-low};
    double area = 0.0;  // mean over the motion keys

    TriangleExtent(const ShapeKeys& shape, const glm::uvec3& corners) {
        for (const shading::Affine3x4& place : shape.transforms) {
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
        area /= static_cast<double>(shape.transforms.size() * shape.meshes.size());
    }
};

// Luminance; 0 if it is not a positive number.
double brightness(const glm::vec3& emission) {
    const double value = luminance(emission);
    return value > 0.0 && std::isfinite(value) ? value : 0.0;
}

// The maximum emitted luminance of a material.
double max_brightness(const shading::Scene& scene, const shading::Material& material) {
    if (!shading::is_used(scene, material.emission_texture)) return brightness(material.emission);
    const shading::Texture& map = scene.textures.items[material.emission_texture.texture];
    double max_luminance = 0.0;
    for (std::uint32_t i = 0; i < map.width * map.height; ++i) {
        max_luminance = std::max(max_luminance,
                                 brightness(material.emission * glm::vec3(shading::texel_at(scene, map, i))));
    }
    return max_luminance;
}

// An emissive mesh with its material.
struct EmissiveMesh {
    const shading::Scene& scene;
    const shading::Material& material;
    const shading::Mesh& mesh;
    double max_luminance;  // luminance

    // Mean luminance of a triangle, sampled on a grid about as fine as its texels. Small details may be missed, so it
    // is at least a hundredth of the maximum: no triangle that may emit has probability 0.
    double mean(const glm::uvec3& corners) const {
        if (!shading::is_used(scene, material.emission_texture)) return max_luminance;
        const unsigned n = steps(corners);
        double sum = 0.0;
        // The triangle is subdivided into n^2 similar ones; in each row, every second one is inverted.
        for (unsigned row = 0; row < n; ++row) {
            for (unsigned i = 0; i < 2 * (n - row) - 1; ++i) {
                const float shift = i % 2 == 0 ? 1.0f / 3.0f : 2.0f / 3.0f;
                const unsigned column = i / 2;
                const glm::vec2 b =
                    (glm::vec2(float(column), float(row)) + glm::vec2(shift)) / static_cast<float>(n);
                sum += brightness(shading::emission_at(scene, material, mesh, corners, b));
            }
        }
        return std::max(sum / (double(n) * n), 0.01 * max_luminance);
    }

  private:
    static constexpr double MaxSteps = 16.0;

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
        return static_cast<unsigned>(std::clamp(longest, 2.0, MaxSteps));
    }
};

// Adds one triangle of an instance as an emitter, and a leaf if it emits.
void add_triangle(EmitterList& list, const EmissiveMesh& emissive, const ShapeKeys& shape,
                  const shading::Instance& instance, std::uint32_t light, std::uint32_t triangle) {
    const glm::uvec3 corners = emissive.mesh.triangles.items[triangle];
    const TriangleExtent extent(shape, corners);
    const double area = extent.area;
    const auto inverse = static_cast<float>(1.0 / std::sqrt(area));
    const auto index = static_cast<std::uint32_t>(list.emitters.size());
    list.emitters.push_back({light, triangle, shading::NoLightNode, shape.deforms ? 0.0f : inverse});
    if (!(inverse > 0.0f) || !std::isfinite(inverse)) return;  // it cannot be hit
    const double sides = emissive.material.double_sided != 0 ? 2.0 : 1.0;
    const double power = area * emissive.mean(corners) * pi * sides;
    if (!(power > 0.0) || !std::isfinite(power)) return;
    // The front side as in shading, independent of the winding in mirrored instances.
    const shading::Triangle face = shading::triangle_of(emissive.mesh, corners);
    const glm::dvec3 front = shading::face_normal(instance, face, glm::vec3(0.0f));
    const bool has_front = front != glm::dvec3(0.0) && !shape.deforms;
    list.leaves.push_back({.low = extent.low,
                           .high = extent.high,
                           .axis = front,
                           .spread = has_front ? 0.0 : pi,
                           .emission_angle = 0.5 * pi,
                           .power = power,
                           .intensity = power / (pi * (has_front ? sides : 4.0)),
                           .emitter = index,
                           .two_sided = has_front && emissive.material.double_sided != 0});
}

}  // namespace

void add_mesh_lights(SceneTables& tables, EmitterList& list) {
    const shading::Scene scene = on_host(tables);
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        shading::Instance& instance = tables.instances[i];
        const shading::Material& material = tables.materials[instance.material];
        if (!shading::emits(material) || material.unlit != 0 || instance.light == shading::ShadowCatcher)
            continue;
        const ShapeKeys shape(tables, instance, tables.meshes[instance.mesh]);
        const EmissiveMesh emissive{scene, material, shape.meshes.front(), max_brightness(scene, material)};
        const std::size_t emitters = list.emitters.size(), leaves = list.leaves.size();
        const auto index = static_cast<std::uint32_t>(tables.lights.size());
        for (std::uint32_t t = 0; t < emissive.mesh.triangle_count; ++t) {
            add_triangle(list, emissive, shape, instance, index, t);
        }
        if (list.leaves.size() == leaves) {  // no triangle emits and can be hit
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

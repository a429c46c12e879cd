// Media of instances, and those that contain the camera.
#include "mediator/backend/tables/media.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/containing_media.h"
#include "mediator/shading/phase.h"
#include "mediator/shading/volume_textures.h"

namespace tessera::backend {

namespace {

using glm::vec3;

vec3 coefficient(const vec3& value) {
    return glm::min(value, vec3(shading::MaxCoefficient));
}

constexpr float IndexOfSurroundings = -1.0f;

shading::Medium medium_of(const scene::Medium& medium, const Indices& textures) {
    shading::Medium record{};
    record.absorption = coefficient(medium.absorption);
    record.scattering = coefficient(medium.scattering);
    record.emission = coefficient(medium.emission);
    record.anisotropy = std::clamp(medium.anisotropy, -shading::MaxAnisotropy, shading::MaxAnisotropy);
    record.priority = medium.priority;
    record.index = IndexOfSurroundings;
    record.textures[shading::MediumAbsorption] = make_use(medium.absorption_texture, textures);
    record.textures[shading::MediumScattering] = make_use(medium.scattering_texture, textures);
    record.textures[shading::MediumEmission] = make_use(medium.emission_texture, textures);
    return record;
}

// KHR_materials_volume: attenuation_color is the transmittance at attenuation_distance, so absorption is
// -log(color) / distance. A component of 0 is replaced by the smallest float.
shading::Medium medium_of(const scene::Material& material) {
    shading::Medium record{};
    for (shading::TextureUse& use : record.textures) use = make_use({}, {});
    if (!(material.attenuation_distance > 0.0f)) return record;
    for (int c = 0; c < 3; ++c) {
        const float left = std::clamp(material.attenuation_color[c], std::numeric_limits<float>::min(), 1.0f);
        record.absorption[c] = -std::log(left) / material.attenuation_distance;
    }
    record.absorption = coefficient(record.absorption);
    return record;
}

// The medium inside a geometry. Solid glass displaces the surrounding medium, even if it is clear.
std::optional<shading::Medium> find_record(const scene::Scene& scene, const Mesh& mesh,
                                           const shading::Material& drawn, const Indices& textures) {
    if (mesh.placeholder) return std::nullopt;
    std::optional<shading::Medium> record;
    if (const auto* medium = scene.find_as<scene::Medium>(mesh.source.medium)) {
        record = medium_of(*medium, textures);
        record->index_matched = mesh.source.material ? 0u : 1u;
    } else if (const auto* material = scene.find_as<scene::Material>(mesh.source.material)) {
        if (material->transmission > 0.0f && material->thickness > 0.0f) record = medium_of(*material);
    }
    if (!record) return record;
    record->index = is_solid_glass(drawn) ? drawn.index_of_refraction : IndexOfSurroundings;
    const vec3 size = mesh.high - mesh.low;
    record->low = mesh.low;
    for (int axis = 0; axis < 3; ++axis)
        record->inverse_size[axis] = size[axis] > 0.0f ? 1.0f / size[axis] : 0.0f;
    record->textured =
        std::ranges::any_of(record->textures, [](const auto& use) { return use.texture >= 0; }) ? 1u : 0u;
    return record;
}

bool shows(const shading::Medium& record) {
    const vec3 sum = record.absorption + record.scattering + record.emission;
    return record.index_matched != 0 || sum != vec3(0.0f);
}

std::uint32_t features_of(const shading::Medium& record) {
    const auto flag = [](bool holds, std::uint32_t feature) { return holds ? feature : 0u; };
    return shading::FeatureMedia | flag(record.index_matched != 0, shading::FeatureIndexMatchedMedia) |
           flag(record.scattering != vec3(0.0f), shading::FeatureScattering) |
           flag(record.textured != 0, shading::FeatureMediaTextures);
}

// The distance from a point inside a mesh to its surface, in object space. Empty if the point is outside: the first
// hit of the ray is a front face, or there is none.
std::optional<double> distance_to_exit(const SceneTables& tables, const shading::Instance& instance,
                                       const glm::dvec3& eye, const glm::dvec3& direction) {
    const auto index = static_cast<std::size_t>(instance.mesh);
    const auto positions = elements<vec3>(tables.arrays[index].positions);
    double nearest = std::numeric_limits<double>::infinity();
    bool leaves = false;
    for (const glm::uvec3& corners : elements<glm::uvec3>(tables.arrays[index].triangles)) {
        const glm::dvec3 p(positions[corners.x]), q = glm::dvec3(positions[corners.y]) - p,
                                                  r = glm::dvec3(positions[corners.z]) - p;
        const glm::dvec3 across = glm::cross(direction, r);
        const double determinant = glm::dot(q, across);
        if (determinant == 0.0) continue;
        const glm::dvec3 from = eye - p, other = glm::cross(from, q);
        const double u = glm::dot(from, across) / determinant;
        const double v = glm::dot(direction, other) / determinant;
        const double distance = glm::dot(r, other) / determinant;
        if (u < 0.0 || v < 0.0 || u + v > 1.0 || !(distance > 0.0) || distance >= nearest) continue;
        nearest = distance;
        leaves = determinant < 0.0;  // a back face: the normal, q x r, points along the ray
    }
    return leaves ? std::optional(nearest) : std::nullopt;
}

std::optional<double> distance_to_exit(const SceneTables& tables, const shading::Instance& instance,
                                       const vec3& eye) {
    const shading::Medium& record = tables.media[static_cast<std::size_t>(instance.medium)];
    const glm::dmat3 linear(instance.linear);
    const glm::dvec3 there = glm::inverse(linear) * (glm::dvec3(eye) - glm::dvec3(instance.translation));
    for (int axis = 0; axis < 3; ++axis) {
        const double place = (there[axis] - double(record.low[axis])) * double(record.inverse_size[axis]);
        if (!(place >= 0.0 && place <= 1.0)) return std::nullopt;
    }
    // A direction that is unlikely to be parallel to an edge of a model.
    const glm::dvec3 direction(0.5291, 0.6317, 0.5666);
    const auto distance = distance_to_exit(tables, instance, there, direction);
    return distance ? std::optional(*distance * glm::length(linear * direction)) : std::nullopt;
}

}  // namespace

void add_media(SceneTables& tables, const scene::Scene& scene, const FlatScene& flat_scene,
               const MeshCatalog& meshes, const Indices& textures) {
    ObjectId last;
    int index = -1;
    std::uint32_t features = 0;
    bool has_holes = false;
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        const ObjectId geometry = flat_scene.instances[i].geometry;
        if (i == 0 || geometry != last) {
            last = geometry;
            const auto record = find_record(scene, *meshes.find(geometry),
                                            tables.materials[tables.instances[i].material], textures);
            index = record ? static_cast<int>(tables.media.size()) : -1;
            if (record) {
                tables.media.push_back(*record);
                if (shows(*record)) features |= features_of(*record);
            }
        }
        tables.instances[i].medium = index;
        if (index < 0) continue;
        const shading::Material& material = tables.materials[tables.instances[i].material];
        has_holes = has_holes || material.alpha_mode != shading::AlphaOpaque;
        if (tables.media.back().index_matched != 0) tables.instances[i].alpha_tested = 1;
    }
    if (has_nested_glass(tables, flat_scene, meshes))
        features |= shading::FeatureMedia | shading::FeatureNestedGlass;
    // Rays that pass a transparent part of the surface enter the medium without refraction.
    if (features != 0 && has_holes) features |= shading::FeatureIndexMatchedMedia;
    tables.scene.features |= features;
    if (features != 0) return;
    tables.media.clear();
    for (shading::Instance& instance : tables.instances) instance.medium = -1;
}

bool is_solid_glass(const shading::Material& material) {
    return material.surface_shader < 0 && material.transmission > 0.0f && material.thin == 0;
}

namespace {

// Relative to the render origin; low > high: empty.
struct Bounds {
    glm::dvec3 low{std::numeric_limits<double>::infinity()};
    glm::dvec3 high{-std::numeric_limits<double>::infinity()};
};

void add_box(Bounds& bounds, const Mesh& mesh, const glm::mat3& linear, const glm::vec3& translation) {
    for (unsigned corner = 0; corner < 8; ++corner) {
        const glm::vec3 object{(corner & 1u) ? mesh.low.x : mesh.high.x,
                               (corner & 2u) ? mesh.low.y : mesh.high.y,
                               (corner & 4u) ? mesh.low.z : mesh.high.z};
        const glm::dvec3 position = linear * object + translation;
        bounds.low = glm::min(bounds.low, position);
        bounds.high = glm::max(bounds.high, position);
    }
}

// Over the shutter.
Bounds bounds_of(const SceneTables& tables, const shading::Instance& instance, const Mesh& mesh) {
    Bounds bounds;
    if (!(mesh.low.x <= mesh.high.x)) return bounds;
    for (const shading::Affine3x4& step : transform_keys_of(tables, instance)) {
        add_box(bounds, mesh, step.linear, step.translation);
    }
    return bounds;
}

}  // namespace

bool has_nested_glass(const SceneTables& tables, const FlatScene& flat_scene, const MeshCatalog& meshes) {
    std::vector<Bounds> glass;
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        if (!is_solid_glass(tables.materials[tables.instances[i].material])) continue;
        glass.push_back(
            bounds_of(tables, tables.instances[i], *meshes.find(flat_scene.instances[i].geometry)));
    }
    std::ranges::sort(glass, {}, [](const Bounds& one) { return one.low.x; });
    // Bounded work: with too many candidates they are assumed to be nested.
    std::size_t comparisons_left = 100 * glass.size() + 1000;
    for (auto one = glass.begin(); one != glass.end(); ++one) {
        for (auto other = one + 1; other != glass.end() && other->low.x <= one->high.x; ++other) {
            const bool overlap = glm::all(glm::lessThanEqual(other->low, one->high)) &&
                                 glm::all(glm::lessThanEqual(one->low, other->high));
            if (overlap || comparisons_left-- == 0) return true;
        }
    }
    return false;
}

glm::uvec4 media_around(const SceneTables& tables, const shading::View& view) {
    glm::uvec4 containing_media = shading::no_media();
    if ((tables.scene.features & shading::FeatureMedia) == 0) return containing_media;
    std::vector<std::pair<double, std::uint32_t>> found;
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        const shading::Instance& instance = tables.instances[i];
        if (instance.medium < 0 || (instance.layers & view.layers) == 0) continue;
        if (const auto distance = distance_to_exit(tables, instance, view.eye))
            found.emplace_back(*distance, i);
    }
    // From the outside in, as a path would enter them.
    std::ranges::sort(found, std::greater{});
    const shading::Scene scene = on_host(tables);
    for (const auto& [distance, instance] : found)
        containing_media = shading::with_medium(scene, containing_media, instance);
    return containing_media;
}

}  // namespace tessera::backend

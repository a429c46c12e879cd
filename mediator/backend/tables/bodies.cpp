// Bodies of media, and those that the eye is in.
#include "mediator/backend/tables/bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/matrix.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <optional>

#include "mediator/backend/tables/parts.h"
#include "mediator/shading/bodies.h"
#include "mediator/shading/phase.h"
#include "mediator/shading/volumes.h"

namespace tessera::backend {

namespace {

using glm::vec3;

vec3 coefficient(const vec3& value) {
    return glm::min(value, vec3(shading::MostCoefficient));
}

constexpr float OfWhatIsAround = -1.0f;

shading::Body body_of(const scene::Medium& medium, const Indices& textures) {
    shading::Body body{};
    body.absorption = coefficient(medium.absorption);
    body.scattering = coefficient(medium.scattering);
    body.emission = coefficient(medium.emission);
    body.anisotropy = std::clamp(medium.anisotropy, -shading::MaxAnisotropy, shading::MaxAnisotropy);
    body.priority = medium.priority;
    body.index = OfWhatIsAround;
    body.textures[shading::BodyAbsorption] = make_use(medium.absorption_texture, textures);
    body.textures[shading::BodyScattering] = make_use(medium.scattering_texture, textures);
    body.textures[shading::BodyEmission] = make_use(medium.emission_texture, textures);
    return body;
}

// KHR_materials_volume: the colour is left after the distance, so absorption is -log(color) / distance. Of a
// channel that is to vanish, the smallest float is left.
shading::Body body_of(const scene::Material& material) {
    shading::Body body{};
    for (shading::TextureUse& use : body.textures) use = make_use({}, {});
    if (!(material.attenuation_distance > 0.0f)) return body;
    for (int c = 0; c < 3; ++c) {
        const float left = std::clamp(material.attenuation_color[c], std::numeric_limits<float>::min(), 1.0f);
        body.absorption[c] = -std::log(left) / material.attenuation_distance;
    }
    body.absorption = coefficient(body.absorption);
    return body;
}

// What a geometry is filled with. Glass with a body keeps out what is around it, even if it is clear.
std::optional<shading::Body> find_body(const scene::Scene& scene, const Mesh& mesh,
                                       const shading::Material& drawn, const Indices& textures) {
    if (mesh.placeholder) return std::nullopt;
    std::optional<shading::Body> body;
    if (const auto* medium = scene.find_as<scene::Medium>(mesh.source.medium)) {
        body = body_of(*medium, textures);
        body->open = mesh.source.material ? 0u : 1u;
    } else if (const auto* material = scene.find_as<scene::Material>(mesh.source.material)) {
        if (material->transmission > 0.0f && material->thickness > 0.0f) body = body_of(*material);
    }
    if (!body) return body;
    body->index = is_solid_glass(drawn) ? drawn.index_of_refraction : OfWhatIsAround;
    const vec3 size = mesh.high - mesh.low;
    body->low = mesh.low;
    for (int axis = 0; axis < 3; ++axis)
        body->inverse_size[axis] = size[axis] > 0.0f ? 1.0f / size[axis] : 0.0f;
    body->textured =
        std::ranges::any_of(body->textures, [](const auto& use) { return use.texture >= 0; }) ? 1u : 0u;
    return body;
}

bool shows(const shading::Body& body) {
    const vec3 sum = body.absorption + body.scattering + body.emission;
    return body.open != 0 || sum != vec3(0.0f);
}

std::uint32_t features_of(const shading::Body& body) {
    const auto flag = [](bool holds, std::uint32_t feature) { return holds ? feature : 0u; };
    return shading::FeatureMedia | flag(body.open != 0, shading::FeatureOpenMedia) |
           flag(body.scattering != vec3(0.0f), shading::FeatureScattering) |
           flag(body.textured != 0, shading::FeatureMediaTextures);
}

// How far from a point, in its own space, a mesh's surface lies in a direction; nothing where the point is
// not inside: what the ray meets first is a front, or nothing.
std::optional<double> way_out(const SceneTables& tables, const shading::Instance& instance,
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
        leaves = determinant < 0.0;  // the normal, q x r, looks along the ray
    }
    return leaves ? std::optional(nearest) : std::nullopt;
}

std::optional<double> way_out(const SceneTables& tables, const shading::Instance& instance, const vec3& eye) {
    const shading::Body& body = tables.bodies[static_cast<std::size_t>(instance.body)];
    const glm::dmat3 linear(instance.linear);
    const glm::dvec3 there = glm::inverse(linear) * (glm::dvec3(eye) - glm::dvec3(instance.translation));
    for (int axis = 0; axis < 3; ++axis) {
        const double place = (there[axis] - double(body.low[axis])) * double(body.inverse_size[axis]);
        if (!(place >= 0.0 && place <= 1.0)) return std::nullopt;
    }
    // Along no edge that a model is likely to have.
    const glm::dvec3 direction(0.5291, 0.6317, 0.5666);
    const auto distance = way_out(tables, instance, there, direction);
    return distance ? std::optional(*distance * glm::length(linear * direction)) : std::nullopt;
}

}  // namespace

void add_bodies(SceneTables& tables, const scene::Scene& scene, const Lowered& lowered,
                const MeshCatalog& meshes, const Indices& textures) {
    ObjectId last;
    int index = -1;
    std::uint32_t features = 0;
    bool has_holes = false;
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        const ObjectId geometry = lowered.instances[i].geometry;
        if (i == 0 || geometry != last) {
            last = geometry;
            const auto body = find_body(scene, *meshes.find(geometry),
                                        tables.materials[tables.instances[i].material], textures);
            index = body ? static_cast<int>(tables.bodies.size()) : -1;
            if (body) {
                tables.bodies.push_back(*body);
                if (shows(*body)) features |= features_of(*body);
            }
        }
        tables.instances[i].body = index;
        if (index < 0) continue;
        const shading::Material& material = tables.materials[tables.instances[i].material];
        has_holes = has_holes || material.alpha_mode != shading::AlphaOpaque;
        if (tables.bodies.back().open != 0) tables.instances[i].alpha_tested = 1;
    }
    if (glass_nests(tables, lowered, meshes)) features |= shading::FeatureMedia | shading::FeatureNestedGlass;
    // Rays that go through a hole in a surface come into the body, as through one that has none.
    if (features != 0 && has_holes) features |= shading::FeatureOpenMedia;
    tables.scene.features |= features;
    if (features != 0) return;
    tables.bodies.clear();
    for (shading::Instance& instance : tables.instances) instance.body = -1;
}

bool is_solid_glass(const shading::Material& material) {
    return material.shader < 0 && material.transmission > 0.0f && material.thin == 0;
}

bool glass_nests(const SceneTables& tables, const Lowered& lowered, const MeshCatalog& meshes) {
    std::vector<Bounds> glass;
    for (std::size_t i = 0; i < tables.instances.size(); ++i) {
        if (!is_solid_glass(tables.materials[tables.instances[i].material])) continue;
        glass.push_back(bounds_of(tables, tables.instances[i], *meshes.find(lowered.instances[i].geometry)));
    }
    std::ranges::sort(glass, {}, [](const Bounds& one) { return one.low.x; });
    // Thousands on end in one plane would take long to tell apart: they are taken for nested.
    std::size_t left_to_ask = 100 * glass.size() + 1000;
    for (auto one = glass.begin(); one != glass.end(); ++one) {
        for (auto other = one + 1; other != glass.end() && other->low.x <= one->high.x; ++other) {
            const bool overlap = glm::all(glm::lessThanEqual(other->low, one->high)) &&
                                 glm::all(glm::lessThanEqual(one->low, other->high));
            if (overlap || left_to_ask-- == 0) return true;
        }
    }
    return false;
}

glm::uvec4 bodies_around(const SceneTables& tables, const shading::View& view) {
    glm::uvec4 inside = shading::nowhere();
    if ((tables.scene.features & shading::FeatureMedia) == 0) return inside;
    std::vector<std::pair<double, std::uint32_t>> found;
    for (std::uint32_t i = 0; i < tables.instances.size(); ++i) {
        const shading::Instance& instance = tables.instances[i];
        if (instance.body < 0 || (instance.layers & view.layers) == 0) continue;
        if (const auto distance = way_out(tables, instance, view.eye)) found.emplace_back(*distance, i);
    }
    // From outside in, as if a path had come here.
    std::ranges::sort(found, std::greater{});
    const shading::Scene scene = on_host(tables);
    for (const auto& [distance, instance] : found) inside = shading::entered(scene, inside, instance);
    return inside;
}

}  // namespace tessera::backend

#include "backends/embree/surface.h"

#include <bit>
#include <cmath>
#include <limits>

namespace tessera::embree {

namespace {

constexpr float UnitRoundoff = 0x1p-24f;
constexpr float gamma(int n) {
    return (float(n) * UnitRoundoff) / (1.0f - float(n) * UnitRoundoff);
}

template <class T>
T interpolate(std::span<const T> values, const glm::uvec3& corners, const glm::vec2& b) {
    return values[corners.x] * (1.0f - b.x - b.y) + values[corners.y] * b.x + values[corners.z] * b.y;
}

// Unit length even where squares would over- or underflow.
glm::vec3 safe_normalize(const glm::vec3& v, const glm::vec3& otherwise) {
    const float scale = shading::largest(glm::abs(v));
    if (!(scale > 0.0f) || !std::isfinite(scale)) return otherwise;
    const glm::vec3 scaled = v / scale;
    return scaled / std::sqrt(glm::dot(scaled, scaled));
}

glm::vec3 face_normal(const InstanceData& instance, const glm::uvec3& corners) {
    const auto& p = instance.mesh->positions;
    // In double: float products of a tiny triangle's edges underflow.
    const glm::dvec3 a = p[corners.x], b = p[corners.y], c = p[corners.z];
    const glm::dvec3 n = glm::cross(b - a, c - a);
    const glm::dvec3 world = glm::dmat3(instance.normals) * n;
    const double length = glm::length(world);
    return length > 0.0 ? glm::vec3(world / length) : glm::vec3(0.0f, 0.0f, 1.0f);
}

glm::vec3 mapped_normal(const SceneTables& tables, const InstanceData& instance, const MaterialData& material,
                        const glm::uvec3& corners, const glm::vec2& b, const glm::vec3& normal) {
    const Mesh& mesh = *instance.mesh;
    if (material.normal_texture.texture < 0 || mesh.tangents.empty() || mesh.tex_coords.empty())
        return normal;
    const glm::vec4 tangent4 = interpolate(mesh.tangents, corners, b);
    glm::vec3 tangent = instance.linear * glm::vec3(tangent4);
    tangent = safe_normalize(tangent - normal * glm::dot(normal, tangent), glm::vec3(0.0f));
    if (tangent == glm::vec3(0.0f)) return normal;
    const glm::vec3 bitangent = glm::cross(normal, tangent) * (tangent4.w < 0.0f ? -1.0f : 1.0f);
    const glm::vec3 texel(
        lookup(tables.textures, material.normal_texture, interpolate(mesh.tex_coords, corners, b)));
    glm::vec3 n = 2.0f * texel - 1.0f;
    n.x *= material.normal_scale;
    n.y *= material.normal_scale;
    return safe_normalize(tangent * n.x + bitangent * n.y + normal * n.z, normal);
}

// As nextafter, towards where `side` points; the library's is a call for every coordinate.
float neighbour(float value, float side) {
    if (value == 0.0f) return std::copysign(std::numeric_limits<float>::denorm_min(), side);
    const auto bits = std::bit_cast<std::int32_t>(value);
    return std::bit_cast<float>((value > 0.0f) == (side > 0.0f) ? bits + 1 : bits - 1);
}

// Directions by the shading normal where they leave the surface on their own sides, else by the geometric
// one: no light may get lost at the rim of a smooth body. Total reflection has to be that of both normals, or
// light would run around inside of a smooth body for ever, which no light from outside can do.
shading::Specular specular_at(const Surface& surface, const shading::Mixture& mixture, float eta,
                              const glm::vec3& direction) {
    glm::mat3 frame = surface.frame;
    shading::Specular specular = shading::make_specular(surface.albedo, mixture, eta, -direction * frame);
    const glm::vec3 up = surface.geometric_normal * frame;
    bool consistent = glm::dot(specular.reflected, up) > 0.0f;
    if (shading::largest(specular.refraction) > 0.0f) {
        consistent = consistent && glm::dot(specular.refracted, up) < 0.0f;
    } else if (mixture.glass > 0.0f) {
        const float cosine = -glm::dot(direction, surface.geometric_normal);
        consistent = consistent && shading::fresnel_dielectric(cosine, eta) == 1.0f;
    }
    if (!consistent) {
        frame = shading::frame_around(surface.geometric_normal);
        specular = shading::make_specular(surface.albedo, mixture, eta, -direction * frame);
    }
    specular.reflected = glm::normalize(frame * specular.reflected);
    specular.refracted = frame * specular.refracted;
    return specular;
}

}  // namespace

PointWithError point_on(const InstanceData& instance, std::uint32_t triangle, const glm::vec2& b) {
    const glm::uvec3 corners = instance.mesh->triangles[triangle];
    const auto& p = instance.mesh->positions;
    const glm::vec3 object = interpolate(p, corners, b);
    const glm::vec3 sizes = glm::abs(p[corners.x]) * std::fabs(1.0f - b.x - b.y) +
                            glm::abs(p[corners.y]) * b.x + glm::abs(p[corners.z]) * b.y;
    const glm::vec3 extent =
        glm::max(glm::max(glm::abs(p[corners.x] - object), glm::abs(p[corners.y] - object)),
                 glm::abs(p[corners.z] - object));
    const glm::mat3 linear(glm::abs(instance.linear[0]), glm::abs(instance.linear[1]),
                           glm::abs(instance.linear[2]));
    const glm::vec3 in_object = linear * (gamma(5) * sizes + gamma(8) * extent);
    const glm::vec3 transform = linear * glm::abs(object) + glm::abs(instance.translation);
    return {instance.to_world(object), in_object + 2.0f * gamma(6) * transform};
}

Surface make_surface(const SceneTables& tables, const RTCHit& hit, const glm::vec3& direction) {
    Surface surface;
    const InstanceData& instance = tables.instances[hit.instID[0]];
    const MaterialData& material = tables.materials[instance.material];
    const Mesh& mesh = *instance.mesh;
    const glm::uvec3 corners = mesh.triangles[hit.primID];
    const glm::vec2 b{hit.u, hit.v};
    const PointWithError point = point_on(instance, hit.primID, b);
    surface.instance = &instance;
    surface.triangle = hit.primID;
    surface.position = point.position;
    surface.error = point.error;

    const glm::vec3 face = face_normal(instance, corners);
    const bool front = glm::dot(face, direction) < 0.0f;
    surface.geometric_normal = front ? face : -face;
    glm::vec3 normal = face;
    if (!mesh.normals.empty()) {
        normal = safe_normalize(instance.normals * interpolate(mesh.normals, corners, b), face);
    }
    normal = mapped_normal(tables, instance, material, corners, b, normal);
    if (!front) normal = -normal;
    // A shading normal that faces away from the viewer describes no surface that can be seen.
    if (!(glm::dot(normal, direction) < 0.0f)) normal = surface.geometric_normal;
    surface.frame = shading::frame_around(normal);

    const glm::vec4 color = base_color_at(tables, instance, hit.primID, b);
    surface.albedo =
        glm::clamp(glm::vec3(color), 0.0f, 1.0f);  // vertex colours may say more than 1: no surface does
    if (material.unlit) {
        surface.emission = glm::vec3(color);
        surface.scatters = false;
        return surface;
    }
    if (material.emits() && (front || material.double_sided)) {
        surface.emission = emission_at(tables, instance, hit.primID, b);
    }
    float metallic = material.metallic, roughness = material.roughness;
    if (material.metallic_roughness_texture.texture >= 0 && !mesh.tex_coords.empty()) {
        const glm::vec4 texel = lookup(tables.textures, material.metallic_roughness_texture,
                                       interpolate(mesh.tex_coords, corners, b));
        roughness *= texel.g;
        metallic *= texel.b;
    }
    const float cos_out = -glm::dot(direction, normal);
    const shading::Mixture mixture = shading::make_mixture(metallic, roughness, material.transmission);
    surface.bsdf =
        shading::make_bsdf(surface.albedo, mixture, roughness, material.index_of_refraction, cos_out);
    if (mixture.mirror > 0.0f || mixture.glass > 0.0f) {
        surface.rough_share = shading::rough_share(mixture);
        // Bodies are solid: behind the front is glass, behind the back is air. Index 0 stands for infinity.
        const float n = material.index_of_refraction;
        surface.specular = specular_at(surface, mixture, front || n == 0.0f ? n : 1.0f / n, direction);
    }
    return surface;
}

glm::vec3 leave_surface(const PointWithError& point, const glm::vec3& normal, const glm::vec3& direction) {
    const float distance = glm::dot(glm::abs(normal), point.error);
    const glm::vec3 offset = glm::dot(normal, direction) < 0.0f ? -distance * normal : distance * normal;
    glm::vec3 left = point.position + offset;
    // The sum itself is rounded: away from the surface, not back onto it.
    for (int i = 0; i < 3; ++i) {
        if (offset[i] != 0.0f) left[i] = neighbour(left[i], offset[i]);
    }
    return left;
}

}  // namespace tessera::embree

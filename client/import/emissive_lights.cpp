#include "client/import/emissive_lights.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "client/import/scene_stats.h"
#include "mediator/picture/color.h"

namespace tessera::import {
namespace {

constexpr double MinIrradiance = 0.2;
constexpr float MaxDiffuseRadiance = 1.0f;

double luminance(const glm::dvec3& color) {
    return picture::luminance(color.x, color.y, color.z);
}

double linear(unsigned srgb_byte) {
    const double value = srgb_byte / 255.0;
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

// Mean of an sRGB image; all emission textures are sRGB.
glm::dvec3 mean_color(std::span<const std::byte> rgba) {
    std::array<double, 256> levels;
    for (unsigned i = 0; i < levels.size(); ++i) levels[i] = linear(i);
    const std::size_t pixels = rgba.size() / 4;
    glm::dvec3 sum(0.0);
    for (std::size_t i = 0; i + 3 < rgba.size(); i += 4) {
        for (std::size_t k = 0; k < 3; ++k)
            sum[static_cast<glm::length_t>(k)] += levels[std::to_integer<unsigned>(rgba[i + k])];
    }
    return sum / std::max(static_cast<double>(pixels), 1.0);
}

struct Emission {
    glm::vec3 factor{0.0f};
    ObjectId texture;
    double sides = 2.0;
};

// Emission of a surface; zero for other objects.
Emission emission_of(const scene::Object& shading_object) {
    if (const auto* material = std::get_if<scene::Material>(&shading_object)) {
        return {material->emission, material->emission_texture.texture, material->double_sided ? 2.0 : 1.0};
    }
    if (const auto* shader = std::get_if<scene::SurfaceShader>(&shading_object)) {
        return {shader->emission, shader->emission_texture.texture};
    }
    return {};
}

}  // namespace

void EmissiveLights::add(ObjectId geometry, const glm::dmat4& world) {
    area_scales_[geometry] += std::pow(std::abs(glm::determinant(glm::dmat3(world))), 2.0 / 3.0);
}

double EmissiveLights::area(const scene::Geometry& geometry) const {
    const auto positions = builder_.stored(geometry.positions).as<glm::vec3>();
    const auto indices = builder_.stored(geometry.indices).as<std::uint32_t>();
    double area = 0.0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        const glm::dvec3 a(positions[indices[i]]), b(positions[indices[i + 1]]), c(positions[indices[i + 2]]);
        area += 0.5 * glm::length(glm::cross(b - a, c - a));
    }
    return area;
}

double EmissiveLights::power(ObjectId id) const {
    const auto& geometry = builder_.get<scene::Geometry>(id);
    const Emission emission = emission_of(builder_.object(geometry.material));
    glm::dvec3 radiance(emission.factor);
    if (emission.texture) {
        const auto& texture = builder_.get<scene::Texture>(emission.texture);
        radiance *= mean_color(builder_.stored(texture.texels).bytes());
    }
    return std::numbers::pi * emission.sides * luminance(radiance) * area(geometry);
}

bool EmissiveLights::are_significant(const Bounds& scene) const {
    const auto is_bright = [&](const auto& entry) {
        const auto& geometry = builder_.get<scene::Geometry>(entry.first);
        if (geometry.medium && emits(builder_.object(geometry.medium))) return true;
        const glm::vec3 factor = emission_of(builder_.object(geometry.material)).factor;
        return std::max({factor.x, factor.y, factor.z}) > MaxDiffuseRadiance;
    };
    if (std::any_of(area_scales_.begin(), area_scales_.end(), is_bright)) return true;
    double power = 0.0;
    for (const auto& [geometry, scale] : area_scales_) power += this->power(geometry) * scale;
    const double radius = 0.5 * glm::length(scene.upper - scene.lower);
    return power >= MinIrradiance * 4.0 * std::numbers::pi * radius * radius;
}

}  // namespace tessera::import

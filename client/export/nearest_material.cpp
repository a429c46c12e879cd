#include "client/export/nearest_material.h"

#include <algorithm>
#include <cmath>
#include <glm/common.hpp>

namespace tessera::exporting {
namespace {

float largest(const glm::vec3& color) {
    return std::max({color.r, color.g, color.b});
}

float fraction(float part, float rest) {
    return part > 0.0f ? part / (part + rest) : 0.0f;
}

// Perceptual roughness for Blinn's exponent 128 x shininess: alpha^2 = 2 / (n + 2).
float roughness_of(const glm::vec2& shininess) {
    const float exponent = 128.0f * 0.5f * (shininess.x + shininess.y);
    return std::pow(2.0f / (exponent + 2.0f), 0.25f);
}

}  // namespace

scene::Material nearest_material(const scene::SurfaceShader& shader) {
    const glm::vec3& indices = shader.relative_index_of_refraction;
    const float relative = (indices.x + indices.y + indices.z) / 3.0f;
    const float index = std::max(relative, 1.0f / relative), b = shader.fresnel_blend;
    const float head_on = (index - 1.0f) * (index - 1.0f) / ((index + 1.0f) * (index + 1.0f));
    const bool is_glass = largest(shader.transmission) > 0.0f;
    // Glass has its own Fresnel reflection.
    const glm::vec3 mirror = shader.reflection * (1.0f - b + (is_glass ? 0.0f : b * head_on));
    const glm::vec3 through = shader.transmission * (1.0f - b + b * (1.0f - head_on));
    const glm::vec3 reflected = shader.specular + mirror;

    scene::Material material;
    material.name = shader.name;
    material.base_color =
        glm::vec4(glm::clamp(shader.diffuse + reflected + through, 0.0f, 1.0f), shader.alpha);
    material.base_color_texture = shader.diffuse_texture;
    material.metallic = fraction(largest(reflected), largest(shader.diffuse) + largest(through));
    material.transmission = fraction(largest(through), largest(shader.diffuse));
    material.specular = is_glass ? 1.0f : 0.0f;
    material.thickness = is_glass && index > 1.0f ? 1.0f : 0.0f;
    material.index_of_refraction = is_glass ? index : 1.5f;
    const float sharp = largest(mirror) + largest(through), glossy = largest(shader.specular);
    if (sharp + glossy > 0.0f) material.roughness = fraction(glossy, sharp) * roughness_of(shader.shininess);
    material.emission = shader.emission;
    material.emission_texture = shader.emission_texture;
    const bool is_sheer = shader.alpha < 1.0f || shader.alpha_texture.texture;
    material.alpha_mode = is_sheer ? scene::AlphaMode::Blend : scene::AlphaMode::Opaque;
    material.double_sided = true;
    if (shader.normal_space == scene::NormalSpace::Tangent &&
        shader.normal_format == scene::NormalFormat::Unorm)
        material.normal_texture = shader.normal_texture;
    return material;
}

}  // namespace tessera::exporting

// CommonSurfaceShader.
#include <algorithm>
#include <array>

#include "mediator/backend/tables/parts.h"

namespace tessera::backend {

namespace {

static_assert(shading::NormalTangent == std::uint32_t(scene::NormalSpace::Tangent) &&
              shading::NormalObject == std::uint32_t(scene::NormalSpace::Object));

// Emission, the diffuse lobe, opacity and the normal map.
scene::Material common_part(const scene::SurfaceShader& shader) {
    const bool transparent = shader.alpha < 1.0f || shader.alpha_texture.texture;
    return {.base_color = glm::vec4(shader.diffuse, shader.alpha),
            .base_color_texture = shader.diffuse_texture,
            .normal_texture = shader.normal_texture,
            .emission = shader.emission,
            .emission_texture = shader.emission_texture,
            .alpha_mode = transparent ? scene::AlphaMode::Blend : scene::AlphaMode::Opaque,
            .double_sided = true};
}

shading::SurfaceShaderParams own_part(const scene::SurfaceShader& shader, const Indices& textures) {
    return {.specular = shader.specular,
            .fresnel_blend = shader.fresnel_blend,
            .shininess = shader.shininess,
            .reflection = shader.reflection,
            .height_scale = shader.height_scale,
            .transmission = shader.transmission,
            .normal_space = static_cast<std::uint32_t>(shader.normal_space),
            .index_of_refraction = shader.relative_index_of_refraction,
            .inverts_alpha = shader.invert_alpha_texture ? 1u : 0u,
            .environment = shader.environment,
            .tangent_set = shader.tangent_tex_coords,
            .normal_scale = shader.normal_scale,
            .binormal_set = shader.binormal_tex_coords,
            .normal_bias = shader.normal_bias,
            .textures = {make_use(shader.specular_texture, textures),
                         make_use(shader.shininess_texture, textures),
                         make_use(shader.reflection_texture, textures),
                         make_use(shader.transmission_texture, textures)},
            .alpha_texture = make_use(shader.alpha_texture, textures),
            .height_texture = make_use(shader.height_texture, textures),
            .environment_texture = make_use(shader.environment_texture, textures)};
}

// The same texels, read as signed bytes. Without mip levels, which are means of unsigned values.
int signed_texture(SceneTables& tables, int texture) {
    const auto place = static_cast<std::size_t>(texture);
    if (texture < 0 || tables.textures[place].format != shading::TexelRgba8) return texture;
    shading::Texture copy = tables.textures[place];
    copy.format = shading::TexelRgba8Signed;
    copy.levels = {};
    copy.level_count = 0;
    tables.textures.push_back(copy);
    tables.texels.push_back(scene::BlobPtr(tables.texels[place]));
    tables.levels.push_back(nullptr);
    return static_cast<int>(tables.textures.size() - 1);
}

}  // namespace

shading::Material add_shader(SceneTables& tables, const scene::SurfaceShader& shader,
                             const Indices& textures) {
    shading::Material material = make_material(common_part(shader), textures);
    if (shader.normal_format == scene::NormalFormat::Snorm)
        material.normal_texture.texture = signed_texture(tables, material.normal_texture.texture);
    // Transmission without refraction.
    if (shader.transmission != glm::vec3(0.0f) && shader.relative_index_of_refraction == glm::vec3(1.0f))
        material.thin |= shading::ThinClear;
    material.surface_shader = static_cast<int>(tables.surface_shaders.size());
    const shading::SurfaceShaderParams& own = tables.surface_shaders.emplace_back(own_part(shader, textures));
    const auto is_used = [](const shading::TextureUse& use) { return use.texture >= 0; };
    if (std::ranges::any_of(own.textures, is_used) || is_used(own.alpha_texture) ||
        is_used(own.height_texture))
        material.filters_color = 0;
    return material;
}

std::uint32_t features_of(const shading::Material& material, const shading::SurfaceShaderParams& shader) {
    const auto is_used = [](const shading::TextureUse& use) { return use.texture >= 0; };
    const std::array uses{material.base_color_texture, material.emission_texture, material.normal_texture,
                          shader.alpha_texture,        shader.height_texture,     shader.environment_texture};
    std::uint32_t features = shading::FeatureSurfaceShader;
    if (std::ranges::any_of(uses, is_used) || std::ranges::any_of(shader.textures, is_used))
        features |= shading::FeatureTextures;
    if (material.alpha_mode != shading::AlphaOpaque) features |= shading::FeatureAlpha;
    const glm::vec3 none(0.0f);
    if (shader.reflection != none || shader.transmission != none) features |= shading::FeatureSpecular;
    return features;
}

}  // namespace tessera::backend

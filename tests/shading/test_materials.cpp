#include "tests/shading/test_materials.h"

namespace tessera::shading {

TextureUse texture_use(int texture, Generator& random) {
    const float angle = random.between(-Pi, Pi), scale = random.between(0.5f, 3.0f);
    return {.texture = texture,
            .set = texture >= 0 ? uint(texture) % 2u : 0u,
            .row_u = {scale * std::cos(angle), scale * std::sin(angle)},
            .row_v = {-scale * std::sin(angle), scale * std::cos(angle)},
            .offset = {random.between(-1.0f, 1.0f), random.between(-1.0f, 1.0f)}};
}

std::vector<Material> make_test_materials(Generator& random) {
    std::vector<Material> materials;
    for (uint i = 0; i < TestMaterials; ++i) {
        Material material{.base_color = vec4(random.color(), 0.8f),
                          .metallic = random.between(0.1f, 0.9f),
                          .roughness = random.between(0.4f, 1.0f),
                          .normal_scale = 0.7f,
                          .index_of_refraction = 1.5f,
                          .alpha_cutoff = 0.5f,
                          .base_color_texture = texture_use(i < 6 ? int(i) : -1, random),
                          .metallic_roughness_texture = texture_use(i == 1 || i == 4 ? 6 : -1, random),
                          .normal_texture = texture_use(i < 3 ? 3 : -1, random),
                          .emission_texture = texture_use(i == 2 ? 2 : -1, random),
                          .alpha_mode = i % 3u,
                          .double_sided = i % 2u,
                          .thin = i % 4u == 1u ? ThinWalled | (i % 8u == 1u ? ThinClear : 0u) : 0u,
                          .extras = i % 2u == 0u ? int(i / 2u) : -1,
                          .surface_shader = i == 1 ? 0 : -1,
                          .filters_color = i % 2u};
        if (i == 2 || i == 6) material.emission = vec3(1.0f, 2.0f, 3.0f);
        materials.push_back(material);
    }
    materials[3].unlit = 1u;
    materials[4].roughness = 0.01f;  // alpha = MinAlpha
    materials[5].transmission = 0.9f;
    materials[6] = {.base_color = vec4(0.9f), .metallic = 1.0f, .roughness = 0.0f};
    materials[6].base_color_texture.texture = materials[6].metallic_roughness_texture.texture =
        materials[6].normal_texture.texture = materials[6].emission_texture.texture = -1;
    materials[6].emission = vec3(0.5f);
    materials[6].extras = -1;
    materials[6].surface_shader = -1;
    materials[7].index_of_refraction = 0.0f;
    materials[7].transmission = 1.0f;
    materials[7].metallic = 0.0f;
    return materials;
}

std::vector<SurfaceShaderParams> make_test_shaders(Generator& random) {
    std::vector<SurfaceShaderParams> shaders;
    for (uint i = 0; i < SurfaceShaderCount; ++i) {
        shaders.push_back(
            {.specular = random.color(),
             .fresnel_blend = random.between(0.0f, 1.0f),
             .shininess = {random.between(0.0f, 4.0f), random.between(0.0f, 1.0f)},
             .reflection = i % 2u == 0u ? random.color() : vec3(0.0f),
             .height_scale = 0.01f,
             .transmission = i == 0u ? random.color() : vec3(0.0f),
             .normal_space = i == 2u ? NormalObject : NormalTangent,
             .index_of_refraction = {1.3f, 1.4f, 1.5f},
             .inverts_alpha = i % 2u,
             .environment = i == 0u ? random.color() : vec3(0.0f),
             .tangent_set = i == 3u ? 0 : -1,
             .normal_scale = vec3(2.0f),
             .binormal_set = i == 3u ? 1 : -1,
             .normal_bias = vec3(-1.0f),
             .textures = {texture_use(i == 1u ? 1 : -1, random), texture_use(i == 2u ? 2 : -1, random),
                          texture_use(-1, random), texture_use(i == 0u ? 1 : -1, random)},
             .alpha_texture = texture_use(i < 2u ? 4 : -1, random),
             .height_texture = texture_use(i == 1u ? 5 : -1, random),
             .environment_texture = texture_use(i == 0u ? 3 : -1, random)});
    }
    return shaders;
}

std::vector<MaterialExtras> make_test_extras(Generator& random) {
    std::vector<MaterialExtras> all;
    for (uint i = 0; i < TestMaterials / 2u; ++i) {
        const auto use = [&](uint bit) {
            return texture_use((i >> bit) % 2u == 1u ? int(1u + bit) : -1, random);
        };
        all.push_back({.specular_color = 2.0f * random.color(),
                       .specular = random.between(0.2f, 1.0f),
                       .sheen_color = i != 1 ? random.color() : vec3(0.0f),
                       .sheen_roughness = random.between(0.2f, 1.0f),
                       .coat = i != 2 ? random.between(0.2f, 1.0f) : 0.0f,
                       .coat_roughness = i == 3 ? 0.0f : random.between(0.3f, 1.0f),
                       .coat_normal_scale = 0.5f,
                       .anisotropy = i != 0 ? random.between(0.2f, 1.0f) : 0.0f,
                       .anisotropy_direction = {0.8f, -0.6f},
                       .iridescence = i == 2 ? 0.7f : 0.0f,
                       .film_index = 1.4f,
                       .film_thickness = {200.0f, 600.0f},
                       .textures = {use(0), use(1), use(0), use(1), use(0), use(1), use(0)},
                       .coat_normal_texture = use(1),
                       .anisotropy_texture = use(1)});
    }
    Generator film_random(false);  // separate, so that all other values stay the same
    for (MaterialExtras& extras : all) {
        extras.textures[ExtrasIridescence] = texture_use(-1, film_random);
        extras.textures[ExtrasThickness] = texture_use(extras.iridescence > 0.0f ? 2 : -1, film_random);
    }
    return all;
}

}  // namespace tessera::shading

#include "client/import/x3d_shaders.h"

#include <cstring>
#include <span>

#include "client/import/x3d_fields.h"

namespace tessera::import {
namespace {

// A field whose value is a texture, by its containerField.
struct TextureField {
    const char* container;
    scene::TextureSlot* slot;
    TextureUse use;
};

// Reads the node's textures into their slots; other children are reported as skipped.
void read_textures(X3dDocument& document, pugi::xml_node node, X3dTextures& textures,
                   std::span<const TextureField> fields) {
    for (const X3dDocument::Child& child : document.children(node)) {
        bool used = false;
        for (const TextureField& field : fields) {
            if (child.container != field.container || std::strcmp(child.node.name(), "ImageTexture") != 0)
                continue;
            field.slot->texture =
                textures.texture(child.node, field.use, x3d_label(node) + "'s " + field.container);
            used = true;
        }
        if (!used && child.container != "phaseFunction")
            document.diagnostics().skipped(child.node.name(), child.node.offset_debug());
    }
}

// An enumerator with two values, with or without X3D's quotes.
template <class Enum>
Enum choice(const X3dFields& fields, const char* field, Enum otherwise, const char* first,
            const char* second) {
    if (!fields.has(field)) return otherwise;
    const std::string word = fields.word(field, "");
    if (word == first) return static_cast<Enum>(0);
    if (word == second) return static_cast<Enum>(1);
    fields.report(std::string(field) + " is '" + word.substr(0, 40) + "', neither " + first + " nor " +
                  second + ": its default is used, correct it");
    return otherwise;
}

}  // namespace

scene::SurfaceShader read_surface_shader(X3dDocument& document, pugi::xml_node node, X3dTextures& textures) {
    const X3dFields fields(node, document.diagnostics());
    scene::SurfaceShader shader;
    shader.name = x3d_name(node);
    shader.emission = fields.vector(fields.has("emissionFactor") ? "emissionFactor" : "emissiveFactor",
                                    shader.emission, NotNegative);
    shader.ambient = fields.vector("ambientFactor", shader.ambient, UpToOne);
    shader.diffuse = fields.vector("diffuseFactor", shader.diffuse, UpToOne);
    shader.specular = fields.vector("specularFactor", shader.specular, UpToOne);
    shader.shininess = fields.number_or_vector("shininessFactor", shader.shininess, {0.0, 1e6});
    shader.alpha = static_cast<float>(fields.number("alphaFactor", shader.alpha, UpToOne));
    shader.invert_alpha_texture = fields.flag("invertAlphaTexture", shader.invert_alpha_texture);
    shader.normal_format = choice(fields, "normalFormat", shader.normal_format, "UNORM", "SNORM");
    shader.normal_space = choice(fields, "normalSpace", shader.normal_space, "TANGENT", "OBJECT");
    shader.normal_scale = fields.vector("normalScale", shader.normal_scale);
    shader.normal_bias = fields.vector("normalBias", shader.normal_bias);
    shader.height_scale = static_cast<float>(fields.number("heightScale", shader.height_scale));
    shader.reflection = fields.vector("reflectionFactor", shader.reflection, UpToOne);
    shader.transmission = fields.vector("transmissionFactor", shader.transmission, UpToOne);
    shader.relative_index_of_refraction = fields.number_or_vector(
        "relativeIndexOfRefraction", shader.relative_index_of_refraction, {0.01, 100.0});
    shader.fresnel_blend = static_cast<float>(fields.number("fresnelBlend", shader.fresnel_blend, UpToOne));
    shader.tangent_tex_coords =
        fields.whole_number("tangentTextureCoordinatesId", shader.tangent_tex_coords, {-1.0, 1.0});
    shader.binormal_tex_coords =
        fields.whole_number("binormalTextureCoordinatesId", shader.binormal_tex_coords, {-1.0, 1.0});
    shader.environment = fields.vector("environmentFactor", shader.environment, NotNegative);
    using enum TextureUse;
    const TextureField slots[] = {{"emissionTexture", &shader.emission_texture, Color},
                                  {"emissiveTexture", &shader.emission_texture, Color},
                                  {"ambientTexture", &shader.ambient_texture, Color},
                                  {"diffuseTexture", &shader.diffuse_texture, Color},
                                  {"specularTexture", &shader.specular_texture, Color},
                                  {"shininessTexture", &shader.shininess_texture, Data},
                                  {"alphaTexture", &shader.alpha_texture, Data},
                                  {"normalTexture", &shader.normal_texture, Data},
                                  {"heightTexture", &shader.height_texture, Data},
                                  {"reflectionTexture", &shader.reflection_texture, Color},
                                  {"transmissionTexture", &shader.transmission_texture, Color},
                                  {"environmentTexture", &shader.environment_texture, Color}};
    read_textures(document, node, textures, slots);
    return shader;
}

scene::SurfaceShader read_material(X3dDocument& document, pugi::xml_node node) {
    const X3dFields fields(node, document.diagnostics());
    scene::SurfaceShader shader;
    shader.name = x3d_name(node);
    shader.diffuse = fields.vector("diffuseColor", shader.diffuse, UpToOne);
    shader.ambient = shader.diffuse * static_cast<float>(fields.number("ambientIntensity", 0.2, UpToOne));
    // X3D says 0 to 1, but brighter emitters are common.
    shader.emission = fields.vector("emissiveColor", shader.emission, NotNegative);
    shader.specular = fields.vector("specularColor", shader.specular, UpToOne);
    shader.shininess = glm::vec2(static_cast<float>(fields.number("shininess", 0.2, UpToOne)));
    shader.alpha = 1.0f - static_cast<float>(fields.number("transparency", 0.0, UpToOne));
    return shader;
}

scene::Medium read_medium(X3dDocument& document, pugi::xml_node node, X3dTextures& textures) {
    const X3dFields fields(node, document.diagnostics());
    scene::Medium medium;
    medium.name = x3d_name(node);
    medium.emission = fields.vector("emissionFactor", medium.emission, NotNegative);
    medium.absorption = fields.vector("absorptionFactor", medium.absorption, NotNegative);
    medium.scattering = fields.vector("scatteringFactor", medium.scattering, NotNegative);
    medium.priority = fields.whole_number("priority", medium.priority, {-1e9, 1e9});
    using enum TextureUse;
    const TextureField slots[] = {{"emissionTexture", &medium.emission_texture, Color},
                                  {"absorptionTexture", &medium.absorption_texture, Data},
                                  {"scatteringTexture", &medium.scattering_texture, Data}};
    read_textures(document, node, textures, slots);
    for (const X3dDocument::Child& child : document.children(node)) {
        if (child.container != "phaseFunction") continue;
        const X3dFields phase(child.node, document.diagnostics());
        if (std::strcmp(child.node.name(), "HenyeyGreenstein") == 0) {
            medium.anisotropy = static_cast<float>(phase.number("anisotropy", 0.0, {-1.0, 1.0}));
        } else {
            phase.report("is an unknown phase function: scattering is isotropic, use HenyeyGreenstein");
        }
    }
    return medium;
}

}  // namespace tessera::import

#include "client/import/assimp_materials.h"

#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>

#include "client/import/image_decoder.h"

namespace tessera::import {
namespace {

glm::vec3 color(const aiMaterial& material, const char* key, glm::vec3 otherwise) {
    aiColor3D value;
    if (material.Get(key, 0, 0, value) != AI_SUCCESS) return otherwise;
    glm::vec3 result{value.r, value.g, value.b};
    for (int i = 0; i < 3; ++i)
        result[i] = std::isfinite(result[i]) ? std::max(result[i], 0.0f) : otherwise[i];
    return result;
}

float number(const aiMaterial& material, const char* key, float otherwise) {
    float value = otherwise;
    if (material.Get(key, 0, 0, value) != AI_SUCCESS || !std::isfinite(value)) return otherwise;
    return value;
}

}  // namespace

ObjectId AssimpMaterials::material(const aiMesh& mesh) {
    ObjectId& made = made_[{mesh.mMaterialIndex, mesh.HasVertexColors(0)}];
    if (!made && mesh.mMaterialIndex < source_.mNumMaterials) made = make(mesh.mMaterialIndex, mesh);
    return made;
}

ObjectId AssimpMaterials::make(unsigned index, const aiMesh& mesh) {
    const aiMaterial& source = *source_.mMaterials[index];
    scene::Material material;
    aiString text;
    if (source.Get(AI_MATKEY_NAME, text) == AI_SUCCESS) material.name = text.C_Str();

    glm::vec3 diffuse = glm::min(color(source, "$clr.diffuse", glm::vec3(0.8f)), glm::vec3(1.0f));
    aiString file;
    const bool textured = source.GetTexture(aiTextureType_DIFFUSE, 0, &file) == AI_SUCCESS;
    // Files with colours or textures but without a material colour mean those as they are, not times a
    // default grey.
    const bool is_default = material.name == AI_DEFAULT_MATERIAL_NAME || material.name.empty();
    if (is_default && (mesh.HasVertexColors(0) || textured)) diffuse = glm::vec3(1.0f);
    material.base_color = glm::vec4(diffuse, std::clamp(number(source, "$mat.opacity", 1.0f), 0.0f, 1.0f));
    if (material.base_color.a < 1.0f) material.alpha_mode = scene::AlphaMode::Blend;
    if (textured) material.base_color_texture.texture = texture(file.C_Str());
    material.emission = glm::min(color(source, "$clr.emissive", glm::vec3(0.0f)), glm::vec3(1e12f));
    if (color(source, "$clr.specular", glm::vec3(0.0f)) != glm::vec3(0.0f)) {
        const float exponent = std::max(number(source, "$mat.shininess", 0.0f), 0.0f);
        material.roughness = std::pow(2.0f / (exponent + 2.0f), 0.25f);  // alpha = roughness^2
    }
    material.double_sided = true;  // these formats have no notion of a back side
    return builder_.add(std::move(material));
}

ObjectId AssimpMaterials::texture(const std::string& named) {
    std::string name = named;
    std::replace(name.begin(), name.end(), '\\', '/');
    const auto [place, is_new] = textures_.try_emplace(name);
    if (!is_new) return place->second;
    std::string cause;
    const auto bytes = folder_.read(name);
    if (!bytes) {
        cause = bytes.error().what();
    } else if (const Expected<DecodedImage> image = decode_image(*bytes)) {
        scene::Texture texture;
        texture.name = name;
        texture.width = image->width;
        texture.height = image->height;
        texture.format = scene::TexelFormat::Rgba8Srgb;
        texture.texels = builder_.blob(image->rgba);
        place->second = builder_.add(std::move(texture));
        ++builder_.result().counts.textures;
    } else {
        cause = image.error().what();
    }
    if (!cause.empty()) {
        builder_.notice("texture '" + name.substr(0, 200) + "' cannot be used (" + cause +
                        "): a magenta checker stands for it");
        place->second = builder_.placeholder_texture();
    }
    return place->second;
}

}  // namespace tessera::import

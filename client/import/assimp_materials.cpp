#include "client/import/assimp_materials.h"

#include <assimp/material.h>
#include <assimp/mesh.h>
#include <assimp/scene.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/import/image_decoder.h"

namespace tessera::import {
namespace {

// Reads the fields of one material. Values that are not finite or out of range are reported and replaced by
// the default.
class Fields {
  public:
    Fields(const aiMaterial& source, const std::string& material, SceneBuilder& builder)
        : source_(source), material_(material), builder_(builder) {}

    glm::vec3 color(const char* key, const char* name, glm::vec3 otherwise, float highest) const {
        aiColor3D value;
        if (source_.Get(key, 0, 0, value) != AI_SUCCESS) return otherwise;
        const glm::vec3 color(value.r, value.g, value.b);
        const bool usable =
            is_within(color.x, highest) && is_within(color.y, highest) && is_within(color.z, highest);
        if (!usable) {
            warn(name, shown(color.x) + " " + shown(color.y) + " " + shown(color.z), highest);
            return otherwise;
        }
        return color;
    }
    float number(const char* key, const char* name, float otherwise, float highest) const {
        float value = otherwise;
        if (source_.Get(key, 0, 0, value) != AI_SUCCESS) return otherwise;
        if (is_within(value, highest)) return value;
        warn(name, shown(value), highest);
        return otherwise;
    }

  private:
    static bool is_within(float value, float highest) { return value >= 0.0f && value <= highest; }
    static std::string shown(float value) {
        char text[32];
        std::snprintf(text, sizeof text, "%g", static_cast<double>(value));
        return text;
    }
    void warn(const std::string& name, const std::string& value, float highest) const {
        builder_.notice("material '" + material_ + "': its " + name + " is " + value + ", outside 0 to " +
                        shown(highest) + ": its default is used, correct it");
    }

    const aiMaterial& source_;
    const std::string& material_;
    SceneBuilder& builder_;
};

constexpr float Brightest = 1e12f;

}  // namespace

ObjectId AssimpMaterials::material(const aiMesh& mesh) {
    ObjectId& result = materials_[{mesh.mMaterialIndex, mesh.HasVertexColors(0)}];
    if (!result && mesh.mMaterialIndex < source_.mNumMaterials) result = make(mesh.mMaterialIndex, mesh);
    return result;
}

ObjectId AssimpMaterials::make(unsigned index, const aiMesh& mesh) {
    const aiMaterial& source = *source_.mMaterials[index];
    scene::Material material;
    aiString text;
    if (source.Get(AI_MATKEY_NAME, text) == AI_SUCCESS) material.name = text.C_Str();

    const std::string name = material.name;
    const Fields fields(source, name, builder_);
    glm::vec3 diffuse = fields.color("$clr.diffuse", "diffuse colour", glm::vec3(0.8f), 1.0f);
    aiString file;
    const bool textured = source.GetTexture(aiTextureType_DIFFUSE, 0, &file) == AI_SUCCESS;
    // Without a material, vertex colours and textures are used as they are, not multiplied by a default grey.
    const bool is_default = material.name == AI_DEFAULT_MATERIAL_NAME || material.name.empty();
    if (is_default && (mesh.HasVertexColors(0) || textured)) diffuse = glm::vec3(1.0f);
    material.base_color = glm::vec4(diffuse, fields.number("$mat.opacity", "opacity", 1.0f, 1.0f));
    if (material.base_color.a < 1.0f) material.alpha_mode = scene::AlphaMode::Blend;
    if (textured) material.base_color_texture.texture = texture(file.C_Str(), name);
    material.emission = fields.color("$clr.emissive", "emission", glm::vec3(0.0f), Brightest);
    if (fields.color("$clr.specular", "specular colour", glm::vec3(0.0f), Brightest) != glm::vec3(0.0f)) {
        const float exponent = fields.number("$mat.shininess", "shininess", 0.0f, Brightest);
        material.roughness = std::pow(2.0f / (exponent + 2.0f), 0.25f);  // alpha = roughness^2
    }
    material.double_sided = true;  // these formats do not define a back side
    return builder_.add(std::move(material));
}

ObjectId AssimpMaterials::texture(const std::string& named, const std::string& material) {
    std::string name = named;
    std::replace(name.begin(), name.end(), '\\', '/');
    const auto [entry, is_new] = textures_.try_emplace(name);
    if (!is_new) return entry->second;
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
        entry->second = builder_.add(std::move(texture));
        ++builder_.result().counts.textures;
    } else {
        cause = image.error().what();
    }
    if (!cause.empty()) {
        builder_.notice("material '" + material + "': texture '" + name.substr(0, 200) +
                        "' cannot be used (" + cause + "): a magenta checkerboard replaces it");
        entry->second = builder_.placeholder_texture();
    }
    return entry->second;
}

}  // namespace tessera::import

#pragma once

#include <map>

#include "client/import/gltf_textures.h"

namespace tinygltf {
class Value;
struct Material;
}  // namespace tinygltf

namespace tessera::import {

struct GltfMaterial {
    ObjectId id;
    bool wants_second_set = false;  // some texture reads TEXCOORD_1
    bool wants_tangents = false;    // it has a normal texture, or its roughness a direction
    std::uint32_t tangent_set = 0;  // of texture coordinates, along which tangents lead
};

// Makes Material, SurfaceShader and Medium objects on demand, each once; -1 is glTF's default material.
class GltfMaterials {
  public:
    GltfMaterials(const tinygltf::Model& model, SceneBuilder& builder)
        : model_(model), builder_(builder), textures_(model, builder) {}

    // An index that the file lacks gives the default material and a notice.
    GltfMaterial material(int index);

    // What the primitive's body is filled with; 0 = nothing.
    ObjectId medium(const tinygltf::Value& primitive_extras);

  private:
    GltfMaterial make(const tinygltf::Material& source, const std::string& fallback_name);
    GltfMaterial make_shader(const tinygltf::Value& fields, const std::string& name);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfTextures textures_;
    std::map<int, GltfMaterial> made_;
    std::map<int, ObjectId> media_;
};

}  // namespace tessera::import

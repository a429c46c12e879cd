#pragma once

#include <map>

#include "client/import/gltf_textures.h"

namespace tinygltf {
struct Material;
}

namespace tessera::import {

struct GltfMaterial {
    ObjectId id;
    int tex_coord_set = 0;        // which TEXCOORD_n its textures read
    bool wants_tangents = false;  // it has a normal texture
};

// Makes Material objects on demand, each once; -1 is glTF's default material.
class GltfMaterials {
  public:
    GltfMaterials(const tinygltf::Model& model, SceneBuilder& builder)
        : model_(model), builder_(builder), textures_(model, builder) {}

    // An index that the file lacks gives the default material and a notice.
    GltfMaterial material(int index);

  private:
    GltfMaterial make(const tinygltf::Material& source, const std::string& fallback_name);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfTextures textures_;
    std::map<int, GltfMaterial> made_;
};

}  // namespace tessera::import

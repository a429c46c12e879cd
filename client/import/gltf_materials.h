#pragma once

#include <map>
#include <set>

#include "client/import/gltf_textures.h"

namespace tinygltf {
class Value;
struct Material;
}  // namespace tinygltf

namespace tessera::import {

struct GltfMaterial {
    ObjectId id;
    bool needs_tex_coords_1 = false;  // a texture uses TEXCOORD_1
    bool needs_tangents = false;      // has a normal texture or is anisotropic
    std::uint32_t tangent_set = 0;    // set of texture coordinates for generated tangents
};

// Creates Material, SurfaceShader and Medium objects on demand, each once; -1 is glTF's default material.
class GltfMaterials {
  public:
    GltfMaterials(const tinygltf::Model& model, SceneBuilder& builder)
        : model_(model), builder_(builder), textures_(model, builder) {}

    // An index out of range gives the default material and a notice.
    GltfMaterial material(int index);

    bool has_volume(ObjectId material) const { return volumes_.contains(material); }  // KHR_materials_volume
    // The same material without its volume, as a thin wall that absorbs what its thickness would.
    ObjectId thin_walled(ObjectId material);

    // The interior medium of the primitive; 0 = none.
    ObjectId medium(const tinygltf::Value& primitive_extras);

  private:
    GltfMaterial make(const tinygltf::Material& source, const std::string& fallback_name);
    GltfMaterial make_shader(const tinygltf::Value& fields, const std::string& name);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfTextures textures_;
    std::map<int, GltfMaterial> materials_;
    std::map<int, ObjectId> media_;
    std::set<ObjectId> volumes_;
    std::map<ObjectId, ObjectId> thin_walled_;
};

}  // namespace tessera::import

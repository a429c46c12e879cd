#pragma once

#include <map>
#include <vector>

#include "client/import/gltf_accessor.h"
#include "client/import/gltf_materials.h"

namespace tinygltf {
struct Primitive;
}

namespace tessera::import {

// Makes Geometry objects on demand: one per primitive of a mesh, each mesh once, so that nodes that share a
// mesh share its geometry.
class GltfMeshes {
  public:
    GltfMeshes(const tinygltf::Model& model, SceneBuilder& builder)
        : model_(model), builder_(builder), accessors_(model), materials_(model, builder) {}

    // Empty when the mesh has only points and lines. A bad mesh is the placeholder, once, and one notice.
    const std::vector<ObjectId>& geometries(int mesh);

  private:
    struct Source {
        MeshData mesh;
        GltfMaterial material;
    };
    Source read(const tinygltf::Primitive& primitive, const std::string& mesh_name);
    ObjectId make(const tinygltf::Primitive& primitive, const std::string& mesh_name,
                  const std::string& name);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfAccessors accessors_;
    GltfMaterials materials_;
    std::map<int, std::vector<ObjectId>> made_;
};

}  // namespace tessera::import

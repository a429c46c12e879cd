#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "client/import/gltf_accessor.h"
#include "client/import/gltf_deformation.h"
#include "client/import/gltf_materials.h"
#include "client/import/playback.h"

namespace tinygltf {
struct Primitive;
}

namespace tessera::import {

// How a node deforms its mesh.
struct MeshPose {
    std::span<const double> weights;       // of the morph targets
    std::span<const glm::dmat4> joints{};  // empty = no skin
};

// Creates Geometry objects on demand: one per primitive, once per mesh, so that nodes that share a mesh share
// its geometries.
class GltfMeshes {
  public:
    GltfMeshes(const tinygltf::Model& model, SceneBuilder& builder)
        : model_(model), builder_(builder), accessors_(model), materials_(model, builder) {}

    // Points and lines become octahedra and tubes. An invalid mesh becomes a placeholder with one notice.
    const std::vector<ObjectId>& geometries(int mesh);

    // Deformed geometries for a single node.
    std::vector<ObjectId> deformed_geometries(int mesh, const MeshPose& pose,
                                              std::vector<DeformedGeometry>& deformed);

  private:
    struct Source {
        MeshData mesh;
        std::vector<JointSet> sets;  // of a compressed mesh
        GltfMaterial material;
        ObjectId medium;
    };
    Source read(const tinygltf::Primitive& primitive, const std::string& mesh_name);
    std::vector<ObjectId> make_all(int mesh, const MeshPose* pose, std::vector<DeformedGeometry>* deformed);
    ObjectId make(const tinygltf::Primitive& primitive, const std::string& mesh_name, const std::string& name,
                  const MeshPose* pose, std::vector<DeformedGeometry>* deformed);

    void check_volumes(const std::vector<ObjectId>& geometries, const std::string& mesh_name);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfAccessors accessors_;
    GltfMaterials materials_;
    std::map<int, std::vector<ObjectId>> geometries_;
};

}  // namespace tessera::import

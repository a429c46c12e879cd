#pragma once

#include <map>
#include <string>
#include <vector>

#include "client/import/gltf_motion.h"

namespace tinygltf {
class Node;
struct Light;
}  // namespace tinygltf

namespace tessera::import {

// Builds the graph: a Transform per node of the default scene, in file order, with its geometries, light and
// camera. Skinned meshes are children of the skeleton root instead of their node. Cycles, second parents and
// nodes nested too deep are removed, each with a notice.
class GltfNodes {
  public:
    GltfNodes(const tinygltf::Model& model, SceneBuilder& builder)
        : model_(model), builder_(builder), accessors_(model), meshes_(model, builder) {}

    std::vector<ObjectId> build();  // the root's children

  private:
    struct Tree {
        std::vector<int> roots;
        std::map<int, std::vector<int>> children;  // of each reachable node, in file order
    };
    Tree traverse();
    std::vector<int> scene_roots();
    std::uint32_t layers_of(int node);
    ObjectId add_transform(int node, GltfMotion& motion);
    // An identity transform below the skeleton root for skinned meshes, with the node's layers.
    ObjectId add_skinned_transform(int node, const std::string& name, const GltfMotion& motion);
    void add_mesh(const tinygltf::Node& node, const std::string& name,
                  const std::vector<ObjectId>& geometries, std::vector<ObjectId>& children);
    // To the units of the options; reports what of it is not used.
    void adapt(scene::Light& light, const tinygltf::Light& source);
    void add_light(const tinygltf::Node& node, const std::string& name, std::vector<ObjectId>& children);
    void add_camera(const tinygltf::Node& node, const std::string& name, std::vector<ObjectId>& children);
    void count_instances(std::uint64_t more);
    std::vector<glm::dmat4> instance_matrices(const tinygltf::Node& node);

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    GltfAccessors accessors_;
    GltfMeshes meshes_;
    std::map<int, ObjectId> lights_;
    bool has_divided_lights_ = false;
    std::uint64_t instances_ = 0;
};

}  // namespace tessera::import

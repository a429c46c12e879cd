#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "client/export/glb_materials.h"

namespace tinygltf {
struct Mesh;
}

namespace tessera::exporting {

// Creates the tree of glTF nodes that the scene graph expands to, with meshes, lights and cameras.
class GlbNodes {
  public:
    GlbNodes(tinygltf::Model& model, const scene::Scene& scene, const scene::BlobStore& blobs,
             std::set<std::string>& notices)
        : model_(model), scene_(scene), buffer_(model, blobs), materials_(model, scene, buffer_, notices) {}

    std::vector<int> build(const std::vector<ObjectId>& roots);  // indices of the root nodes

  private:
    struct PendingNode {
        ObjectId transform;
        int node;
    };
    int add_node(const std::string& name);
    // Adds the objects to a node; returns its child nodes. -1: the scene itself; returns the root nodes.
    std::vector<int> attach(const std::vector<ObjectId>& objects, int node);
    void attach_geometries(const std::vector<ObjectId>& geometries, int node, std::vector<int>& below);
    int mesh(const std::vector<ObjectId>& geometries);
    int light(ObjectId id);
    int camera(ObjectId id);

    tinygltf::Model& model_;
    const scene::Scene& scene_;
    GlbBuffer buffer_;
    GlbMaterials materials_;
    std::vector<PendingNode> pending_;  // nodes whose children are not yet added
    std::map<std::vector<ObjectId>, int> meshes_;
    std::map<ObjectId, int> lights_, cameras_;
};

}  // namespace tessera::exporting

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

// Makes the tree of glTF nodes that the scene's graph unfolds to, with meshes, lights and cameras.
class GlbNodes {
  public:
    GlbNodes(tinygltf::Model& model, const scene::Scene& scene, const scene::BlobStore& blobs,
             std::set<std::string>& notices)
        : model_(model), scene_(scene), buffer_(model, blobs), materials_(model, scene, buffer_, notices) {}

    std::vector<int> build(const std::vector<ObjectId>& roots);  // numbers of the root nodes

  private:
    struct Place {
        ObjectId transform;
        int node;
    };
    int add_node(const std::string& name);
    // Hangs the objects into a node (or, for -1, beside each other at the root; then the nodes are returned).
    std::vector<int> hang(const std::vector<ObjectId>& objects, int node);
    void hang_geometries(const std::vector<ObjectId>& geometries, int node, std::vector<int>& below);
    int mesh(const std::vector<ObjectId>& geometries);
    int light(ObjectId id);
    int camera(ObjectId id);

    tinygltf::Model& model_;
    const scene::Scene& scene_;
    GlbBuffer buffer_;
    GlbMaterials materials_;
    std::vector<Place> open_;  // nodes whose transforms' children are still to be hung in
    std::map<std::vector<ObjectId>, int> meshes_;
    std::map<ObjectId, int> lights_, cameras_;
};

}  // namespace tessera::exporting

#pragma once

#include <map>

#include "backends/embree/device.h"
#include "mediator/backend/tables/meshes.h"

namespace tessera::embree {

enum class AlphaTest { Off, On };

// Embree's bottom level: one scene per mesh, shared by all its instances. Vertices stay in their blobs.
class MeshScenes {
  public:
    explicit MeshScenes(RTCDevice device) : device_(device) {}

    // Applies the catalog's changes. The blobs of its meshes must outlive the scenes.
    void update(const backend::MeshCatalog& catalog, const backend::MeshCatalog::Result& edit);
    void set_alpha_tested(ObjectId id, AlphaTest test);  // whether hits call the filter function in alpha.h

    RTCScene find(ObjectId id) const { return meshes_.at(id).scene.get(); }

  private:
    struct MeshScene {
        SceneHandle scene;
        RTCGeometry geometry = nullptr;  // owned by the scene
        scene::BlobPtr triangles;        // currently attached
        bool alpha_tested = false;
    };
    MeshScene build(const backend::Mesh& mesh) const;
    static void refit(MeshScene& built, const backend::Mesh& mesh);

    RTCDevice device_;
    std::map<ObjectId, MeshScene> meshes_;
};

}  // namespace tessera::embree

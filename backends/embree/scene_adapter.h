#pragma once

#include <memory>

#include "backends/embree/meshes.h"
#include "mediator/backend/edit_report.h"

namespace tessera::embree {

// The scene adapter: mirrors the scene in Embree at the cheapest level that can hold each change. Shading
// data are tables; a moved instance is retransformed, moved vertices of an animated mesh are refitted (Embree
// cannot if they move while the shutter is open), any other change of a mesh is a rebuild. Embree rebuilds
// the top level at each commit.
class SceneAdapter {
  public:
    SceneAdapter(RTCDevice device, std::shared_ptr<scene::BlobStore> blobs);

    Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) {
        return shadow_.apply(changes, after);
    }
    // For callers without their own scene.
    Expected<void> apply(const scene::ChangeList& changes) { return shadow_.apply(changes); }
    void rollback() { shadow_.rollback(); }
    // After an error the last committed version is there again.
    Expected<backend::EditReport> commit();

    Version version() const { return version_; }
    const scene::Scene& content() const { return shadow_.scene(); }  // with all applied change lists
    const backend::SceneTables& tables() const { return tables_; }
    RTCScene scene() const { return top_.get(); }

  private:
    backend::EditReport build(const backend::SceneDelta& delta);
    void restore();
    void rebuild_top();
    std::uint32_t retransform(const backend::SceneDelta& delta);
    void update_instance(std::uint32_t instance);
    void mark_alpha_tested();

    RTCDevice device_;
    std::shared_ptr<scene::BlobStore> blobs_;
    backend::ShadowScene shadow_;
    Version version_;
    backend::MeshCatalog meshes_;
    backend::MipmapCache mipmaps_;
    MeshScenes mesh_scenes_;
    backend::SceneTables tables_;
    SceneHandle top_;
};

}  // namespace tessera::embree

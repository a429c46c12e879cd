#pragma once

#include <memory>

#include "backends/vulkan/gpu_scene.h"
#include "mediator/backend/edit_report.h"

namespace tessera::vulkan {

// The scene adapter: the mirror of the scene on the host and what of it is on the device, at the cheapest
// level that can hold each change. What does not fit into the device's memory is refused, and the last good
// version stays.
class World final {
  public:
    explicit World(std::shared_ptr<scene::BlobStore> blobs) : blobs_(std::move(blobs)), meshes_(blobs_) {}

    // To a device that is new, or that was lost: everything is sent there. Null: lets go of it.
    void move_to(Device* device);

    Expected<void> apply(const scene::ChangeList& changes) { return shadow_.apply(changes); }
    void rollback() { shadow_.rollback(); }
    Expected<backend::EditReport> commit();

    Version version() const { return version_; }
    const backend::SceneTables& tables() const { return tables_; }
    const GpuScene& scene() const { return *scene_; }

  private:
    void rebuild();
    Expected<backend::EditReport> refuse(const Error& error);

    std::shared_ptr<scene::BlobStore> blobs_;
    backend::ShadowScene shadow_;
    Version version_;
    backend::MeshCatalog meshes_;
    backend::SceneTables tables_;
    Device* device_ = nullptr;
    std::unique_ptr<GpuScene> scene_;
    backend::MaterialProblems problems_;
};

}  // namespace tessera::vulkan

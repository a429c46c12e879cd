#pragma once

#include <filesystem>
#include <memory>

#include "backends/vulkan/gpu_scene.h"
#include "mediator/backend/edit_report.h"

namespace tessera::vulkan {

// The scene adapter: the mirror of the scene on the host and what of it is on the device, at the cheapest
// level that can hold each change. What does not fit into the device's memory is refused, and the last good
// version stays.
class World final {
  public:
    // Built trees are kept in the folder, see TreeCache.
    World(std::shared_ptr<scene::BlobStore> blobs, const std::filesystem::path& cache_folder,
          Trees trees = Trees::Wide)
        : blobs_(std::move(blobs)), meshes_(blobs_), cache_(cache_folder), trees_(trees) {}

    // To a device that is new, or that was lost: everything is sent there. Null: lets go of it. Throws
    // Error{OutOfMemory} and DeviceLost; nothing is on the device then.
    void move_to(Device* device);
    // Whether the scene is on a device; only then may scene() and commit() be called.
    bool is_on_device() const { return scene_ != nullptr; }

    Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) {
        return shadow_.apply(changes, after);
    }
    // For owners that keep no scene.
    Expected<void> apply(const scene::ChangeList& changes) { return shadow_.apply(changes); }
    // To the last version that was committed.
    void rollback();
    // May be called again after DeviceLost, on another device.
    Expected<backend::EditReport> commit();

    Version version() const { return version_; }
    const scene::Scene& content() const { return shadow_.scene(); }  // after all lists that were applied
    const backend::SceneTables& tables() const { return tables_; }
    const GpuScene& scene() const { return *scene_; }

  private:
    void rebuild();
    void restore();
    Expected<backend::EditReport> refuse(const Error& error);

    std::shared_ptr<scene::BlobStore> blobs_;
    backend::ShadowScene shadow_;
    Version version_;
    backend::MeshCatalog meshes_;
    backend::TexturePyramids pyramids_;
    backend::SceneTables tables_;
    bool ahead_ = false;  // meshes and tables are those of a version that is not committed
    TreeCache cache_;
    Trees trees_;
    Device* device_ = nullptr;
    std::unique_ptr<GpuScene> scene_;
};

}  // namespace tessera::vulkan

#pragma once

#include <filesystem>
#include <memory>

#include "backends/vulkan/gpu_scene.h"
#include "mediator/backend/edit_report.h"

namespace tessera::vulkan {

// The mirror of the scene on the host and its representation on the device, updated incrementally. A version
// that cannot be built, e.g. since it does not fit into device memory, is rejected, and the last good one is kept.
class SceneAdapter final {
  public:
    // BVHs are cached in the folder, see TreeCache.
    SceneAdapter(std::shared_ptr<scene::BlobStore> blobs, const std::filesystem::path& cache_folder,
                 Trees trees = Trees::Wide)
        : blobs_(std::move(blobs)), meshes_(blobs_), cache_(cache_folder), trees_(trees) {}

    // Uploads everything to a new or reopened device. Null: releases the device. Throws Error{OutOfMemory} and
    // DeviceLost; nothing is on the device then.
    void move_to(Device* device);
    // Whether the scene is on a device; only then may scene() and commit() be called.
    bool is_on_device() const { return scene_ != nullptr; }

    Expected<void> apply(const scene::ChangeList& changes, const scene::Scene& after) {
        return shadow_.apply(changes, after);
    }
    // For owners without a scene of their own.
    Expected<void> apply(const scene::ChangeList& changes) { return shadow_.apply(changes); }
    // Reverts to the last committed version.
    void rollback();
    // May be called again after DeviceLost, on another device.
    Expected<backend::EditReport> commit();

    Version version() const { return version_; }
    const scene::Scene& content() const { return shadow_.scene(); }  // with all applied change lists
    const backend::SceneTables& tables() const { return tables_; }
    const GpuScene& scene() const { return *scene_; }

  private:
    void rebuild();
    void restore();
    Expected<backend::EditReport> reject(const Error& error);

    std::shared_ptr<scene::BlobStore> blobs_;
    backend::ShadowScene shadow_;
    Version version_;
    backend::MeshCatalog meshes_;
    backend::MipmapCache mipmaps_;
    backend::SceneTables tables_;
    bool uncommitted_ = false;  // meshes and tables are those of a version that is not committed
    TreeCache cache_;
    Trees trees_;
    Device* device_ = nullptr;
    std::unique_ptr<GpuScene> scene_;
};

}  // namespace tessera::vulkan

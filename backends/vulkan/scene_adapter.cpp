#include "backends/vulkan/scene_adapter.h"

#include <iterator>

#include "backends/vulkan/device/device.h"
#include "backends/vulkan/device/result.h"

namespace tessera::vulkan {

namespace {

void add_notes(std::vector<std::string> notes, std::vector<std::string>& problems) {
    problems.insert(problems.end(), std::make_move_iterator(notes.begin()),
                    std::make_move_iterator(notes.end()));
}

}  // namespace

void SceneAdapter::move_to(Device* device) {
    scene_.reset();
    device_ = device;
    if (device_ != nullptr) rebuild();
}

void SceneAdapter::rebuild() {
    scene_.reset();
    auto scene = std::make_unique<GpuScene>(*device_, cache_, trees_);
    scene->update(meshes_, meshes_.everything(), tables_);
    scene_ = std::move(scene);
}

void SceneAdapter::rollback() {
    shadow_.rollback();
    if (uncommitted_) restore();
}

// Rebuilds the host's tables from the shadow scene. The device may hold parts of another version: it is cleared.
void SceneAdapter::restore() {
    scene_.reset();
    meshes_ = backend::MeshCatalog(blobs_);
    meshes_.update(shadow_.scene(), backend::everything_in(shadow_.scene()));
    tables_ = backend::make_tables(shadow_.scene(), shadow_.flat_scene(), meshes_, *blobs_, mipmaps_);
    uncommitted_ = false;
}

Expected<backend::EditReport> SceneAdapter::commit() {
    const backend::SceneDelta delta = shadow_.pending();
    uncommitted_ = true;
    const std::uint64_t uploaded = device_->uploaded_bytes();
    const backend::MeshCatalog::Result changes = meshes_.update(shadow_.scene(), delta);
    backend::update_tables(tables_, shadow_.scene(), shadow_.flat_scene(), meshes_, *blobs_, mipmaps_, delta);
    try {
        const BvhPool::Work work = scene_->update(meshes_, changes, tables_);
        shadow_.accept();
        uncommitted_ = false;
        version_ = shadow_.scene().version();
        backend::EditReport report = backend::make_report(delta, meshes_, changes, tables_);
        report.rebuilt = work.rebuilt;
        report.refitted = work.refitted;
        report.uploaded_bytes = device_->uploaded_bytes() - uploaded;
        if (!delta.everything && !delta.instances_changed) {
            report.retransformed = static_cast<std::uint32_t>(delta.moved_instances.size());
        }
        add_notes(cache_.take_notes(), report.problems);
        add_notes(device_->pipelines().take_notes(), report.problems);
        return report;
    } catch (const DeviceLost&) {
        throw;
    } catch (const Error& error) {
        return reject(error);
    }
}

Expected<backend::EditReport> SceneAdapter::reject(const Error& error) {
    rollback();
    rebuild();
    const std::string kept = "; version " + std::to_string(version_.number) + " is kept";
    if (error.code() != ErrorCode::OutOfMemory) return failure(error.code(), error.what() + kept);
    return failure(ErrorCode::OutOfMemory, "the scene does not fit into the memory of device " +
                                               device_->info().name + ": " + error.what() + kept);
}

}  // namespace tessera::vulkan

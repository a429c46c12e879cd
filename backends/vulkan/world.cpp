#include "backends/vulkan/world.h"

#include <iterator>

#include "backends/vulkan/device/device.h"

namespace tessera::vulkan {

namespace {

backend::MeshCatalog::Result everything_in(const backend::MeshCatalog& meshes) {
    backend::MeshCatalog::Result all{.everything = true};
    for (const auto& [id, mesh] : meshes.all()) all.changes.push_back({id, backend::MeshStep::Rebuild});
    return all;
}

// As if the scene had come as a snapshot.
backend::SceneDelta everything_in(const scene::Scene& scene) {
    backend::SceneDelta all{.everything = true};
    for (const auto& [id, object] : scene.objects()) {
        if (std::holds_alternative<scene::Geometry>(*object)) all.geometries.push_back({id, {}});
    }
    return all;
}

void add_notes(std::vector<std::string> notes, std::vector<std::string>& problems) {
    problems.insert(problems.end(), std::make_move_iterator(notes.begin()),
                    std::make_move_iterator(notes.end()));
}

}  // namespace

void World::move_to(Device* device) {
    scene_.reset();
    device_ = device;
    if (device_ != nullptr) rebuild();
}

void World::rebuild() {
    scene_.reset();
    auto scene = std::make_unique<GpuScene>(*device_, cache_, trees_);
    scene->update(meshes_, everything_in(meshes_), tables_);
    scene_ = std::move(scene);
}

void World::rollback() {
    shadow_.rollback();
    if (ahead_) restore();
}

// The host's side from the shadow scene; the device may hold parts of another version: it lets go of all.
void World::restore() {
    scene_.reset();
    meshes_ = backend::MeshCatalog(blobs_);
    meshes_.update(shadow_.scene(), everything_in(shadow_.scene()));
    tables_ = backend::make_tables(shadow_.scene(), shadow_.lowered(), meshes_, *blobs_, pyramids_);
    ahead_ = false;
}

Expected<backend::EditReport> World::commit() {
    const backend::SceneDelta delta = shadow_.pending();
    ahead_ = true;
    const std::uint64_t uploaded = device_->uploaded_bytes();
    const backend::MeshCatalog::Result changes = meshes_.update(shadow_.scene(), delta);
    backend::update_tables(tables_, shadow_.scene(), shadow_.lowered(), meshes_, *blobs_, pyramids_, delta);
    try {
        const BvhPool::Work work = scene_->update(meshes_, changes, tables_);
        shadow_.accept();
        ahead_ = false;
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
    } catch (const Error& error) {
        if (error.code() != ErrorCode::OutOfMemory) throw;
        return refuse(error);
    }
}

Expected<backend::EditReport> World::refuse(const Error& error) {
    rollback();
    rebuild();
    return failure(ErrorCode::OutOfMemory, "the scene does not fit into the memory of " +
                                               device_->info().name + ": " + error.what() + "; version " +
                                               std::to_string(version_.number) + " stays");
}

}  // namespace tessera::vulkan

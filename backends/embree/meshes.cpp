#include "backends/embree/meshes.h"

#include "backends/embree/alpha.h"

namespace tessera::embree {

namespace {

void attach_triangles(RTCGeometry geometry, const backend::Mesh& mesh) {
    const auto triangles = backend::elements<glm::uvec3>(mesh.triangles);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.data(), 0,
                               sizeof(glm::uvec3), triangles.size());
}

void attach_positions(RTCGeometry geometry, const backend::Mesh& mesh) {
    const auto positions = backend::elements<glm::vec3>(mesh.positions);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions.data(), 0,
                               sizeof(glm::vec3), positions.size());
    for (std::size_t i = 0; i < mesh.motion_positions.size(); ++i) {
        const auto step = backend::elements<glm::vec3>(mesh.motion_positions[i]);
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(i + 1),
                                   RTC_FORMAT_FLOAT3, step.data(), 0, sizeof(glm::vec3), step.size());
    }
}

}  // namespace

void MeshScenes::update(const backend::MeshCatalog& catalog, const backend::MeshCatalog::Result& edit) {
    if (edit.everything) meshes_.clear();
    for (const ObjectId id : edit.removed) meshes_.erase(id);
    for (const auto& change : edit.changes) {
        const backend::Mesh& mesh = *catalog.find(change.id);
        switch (change.step) {
            case backend::MeshUpdate::ShadingData:
                break;
            case backend::MeshUpdate::Refit:
                refit(meshes_.at(change.id), mesh);
                break;
            case backend::MeshUpdate::Rebuild:
                meshes_[change.id] = build(mesh);
                break;
        }
    }
    check(device_, "building meshes");
}

MeshScenes::MeshScene MeshScenes::build(const backend::Mesh& mesh) const {
    MeshScene built;
    built.scene.reset(rtcNewScene(device_));
    rtcSetSceneFlags(built.scene.get(),
                     mesh.refits ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST);
    // With other build qualities Embree rebuilds instead of refitting.
    if (mesh.refits) rtcSetSceneBuildQuality(built.scene.get(), RTC_BUILD_QUALITY_LOW);
    const GeometryHandle handle(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE));
    built.geometry = handle.get();
    built.triangles = mesh.triangles;
    rtcSetGeometryBuildQuality(handle.get(),
                               mesh.refits ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM);
    rtcSetGeometryTimeStepCount(handle.get(), static_cast<unsigned>(mesh.motion_positions.size() + 1));
    attach_triangles(handle.get(), mesh);
    attach_positions(handle.get(), mesh);
    rtcCommitGeometry(handle.get());
    rtcAttachGeometryByID(built.scene.get(), handle.get(), 0);
    rtcCommitScene(built.scene.get());
    return built;
}

// Same triangles, moved vertices: the tree is kept, its boxes are updated.
void MeshScenes::refit(MeshScene& built, const backend::Mesh& mesh) {
    // Equal triangles may have moved to another address; Embree treats any newly attached buffer as a change.
    if (built.triangles != mesh.triangles) attach_triangles(built.geometry, mesh);
    built.triangles = mesh.triangles;
    attach_positions(built.geometry, mesh);
    rtcUpdateGeometryBuffer(built.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(built.geometry);
    rtcCommitScene(built.scene.get());
}

void MeshScenes::set_alpha_tested(ObjectId id, AlphaTest test) {
    MeshScene& mesh = meshes_.at(id);
    const bool wanted = test == AlphaTest::On;
    if (mesh.alpha_tested == wanted) return;
    mesh.alpha_tested = wanted;
    rtcSetGeometryIntersectFilterFunction(mesh.geometry, wanted ? alpha_filter : nullptr);
    rtcSetGeometryOccludedFilterFunction(mesh.geometry, wanted ? alpha_filter : nullptr);
    rtcCommitGeometry(mesh.geometry);
    rtcCommitScene(mesh.scene.get());
}

}  // namespace tessera::embree

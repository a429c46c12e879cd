#include "backends/embree/scene_adapter.h"

#include <array>
#include <new>
#include <utility>

namespace tessera::embree {

namespace {

void set_transform(RTCGeometry geometry, unsigned step, const glm::mat3& linear,
                   const glm::vec3& translation) {
    const std::array<float, 12> columns{linear[0].x, linear[0].y,   linear[0].z,   linear[1].x,
                                        linear[1].y, linear[1].z,   linear[2].x,   linear[2].y,
                                        linear[2].z, translation.x, translation.y, translation.z};
    rtcSetGeometryTransform(geometry, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
}

}  // namespace

SceneAdapter::SceneAdapter(RTCDevice device, std::shared_ptr<scene::BlobStore> blobs)
    : device_(device),
      blobs_(std::move(blobs)),
      meshes_(blobs_),
      mesh_scenes_(device),
      top_(rtcNewScene(device)) {
    rtcCommitScene(top_.get());
}

Expected<backend::EditReport> SceneAdapter::commit() {
    try {
        backend::EditReport report = build(shadow_.pending());
        shadow_.accept();
        version_ = shadow_.scene().version();
        return report;
    } catch (const Error& error) {
        restore();
        return failure(error.code(), std::string(error.what()) + "; version " +
                                         std::to_string(version_.number) + " is kept");
    } catch (const std::bad_alloc&) {
        restore();
        return failure(ErrorCode::OutOfMemory, "the scene does not fit into memory; version " +
                                                   std::to_string(version_.number) + " is kept");
    }
}

backend::EditReport SceneAdapter::build(const backend::SceneDelta& delta) {
    const backend::MeshCatalog::Result meshes = meshes_.update(shadow_.scene(), delta);
    mesh_scenes_.update(meshes_, meshes);
    const backend::TablesUpdate step = backend::update_tables(tables_, shadow_.scene(), shadow_.flat_scene(),
                                                              meshes_, *blobs_, mipmaps_, delta);
    if (step == backend::TablesUpdate::Rebuilt) mark_alpha_tested();
    backend::EditReport edit = backend::make_report(delta, meshes_, meshes, tables_);
    if (delta.everything || delta.instances_changed || delta.render_origin_changed ||
        meshes.count(backend::MeshUpdate::Rebuild) > 0) {
        rebuild_top();
    } else {
        edit.retransformed = retransform(delta);
        if (edit.retransformed > 0 || edit.refitted > 0) rtcCommitScene(top_.get());
    }
    check(device_, "building the top level");
    return edit;
}

// What was built in part is of the version that failed: everything is made again from the last committed scene.
void SceneAdapter::restore() {
    shadow_.rollback();
    const Version kept = std::exchange(version_, {});  // no unit is rendered if this fails as well
    meshes_ = backend::MeshCatalog(blobs_);
    meshes_.update(shadow_.scene(), backend::everything_in(shadow_.scene()));
    mesh_scenes_.update(meshes_, meshes_.everything());
    tables_ = backend::make_tables(shadow_.scene(), shadow_.flat_scene(), meshes_, *blobs_, mipmaps_);
    mark_alpha_tested();
    rebuild_top();
    check(device_, "restoring the last version");
    version_ = kept;
}

void SceneAdapter::update_instance(std::uint32_t instance) {
    const shading::Instance& data = tables_.instances[instance];
    const RTCGeometry geometry = rtcGetGeometry(top_.get(), instance);
    if (data.motion < 0) {
        rtcSetGeometryTimeStepCount(geometry, 1);
        set_transform(geometry, 0, data.linear, data.translation);
    } else {
        const shading::Motion& motion = tables_.motions[static_cast<std::size_t>(data.motion)];
        rtcSetGeometryTimeStepCount(geometry, motion.key_intervals + 1);
        for (std::uint32_t step = 0; step <= motion.key_intervals; ++step) {
            const shading::Affine3x4& place = tables_.transform_keys[motion.first_key + step];
            set_transform(geometry, step, place.linear, place.translation);
        }
    }
    rtcSetGeometryMask(geometry, data.layers);
    rtcCommitGeometry(geometry);
}

void SceneAdapter::rebuild_top() {
    top_.reset(rtcNewScene(device_));
    rtcSetSceneFlags(top_.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::uint32_t i = 0; i < tables_.instances.size(); ++i) {
        const GeometryHandle geometry(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(geometry.get(),
                                     mesh_scenes_.find(ObjectId{tables_.instances[i].object}));
        rtcAttachGeometryByID(top_.get(), geometry.get(), i);
        update_instance(i);
    }
    rtcCommitScene(top_.get());
}

std::uint32_t SceneAdapter::retransform(const backend::SceneDelta& delta) {
    for (const std::uint32_t instance : delta.moved_instances) update_instance(instance);
    if (!delta.geometries.empty()) {
        // Instances of a refitted mesh have other bounds.
        std::set<ObjectId> changed;
        for (const auto& change : delta.geometries) changed.insert(change.id);
        for (std::uint32_t i = 0; i < tables_.instances.size(); ++i) {
            if (changed.contains(ObjectId{tables_.instances[i].object})) {
                rtcCommitGeometry(rtcGetGeometry(top_.get(), i));
            }
        }
    }
    return static_cast<std::uint32_t>(delta.moved_instances.size());
}

void SceneAdapter::mark_alpha_tested() {
    for (const shading::Instance& instance : tables_.instances) {
        mesh_scenes_.set_alpha_tested(ObjectId{instance.object},
                                      instance.alpha_tested != 0 ? AlphaTest::On : AlphaTest::Off);
    }
}

}  // namespace tessera::embree

#include "backends/embree/world.h"

#include <array>

#include "mediator/shading/bsdf.h"

namespace tessera::embree {

World::World(RTCDevice device, std::shared_ptr<scene::BlobStore> blobs)
    : device_(device),
      blobs_(std::move(blobs)),
      meshes_(blobs_),
      mesh_scenes_(device),
      top_(rtcNewScene(device)) {
    rtcCommitScene(top_.get());
}

Expected<backend::EditReport> World::commit() {
    backend::SceneDelta delta = shadow_.take_delta();
    const backend::MeshCatalog::Result meshes = meshes_.update(shadow_.scene(), delta);
    mesh_scenes_.update(meshes_, meshes);
    tables_ = backend::make_tables(shadow_.scene(), shadow_.lowered(), meshes_, *blobs_);
    mark_alpha_tested();
    backend::EditReport edit = report(delta, meshes);
    if (delta.everything || delta.instances_changed || delta.render_origin_changed ||
        meshes.count(backend::MeshStep::Rebuild) > 0) {
        rebuild_top();
    } else {
        edit.retransformed = retransform(delta);
        if (edit.retransformed > 0 || edit.refitted > 0) rtcCommitScene(top_.get());
    }
    check(device_, "building the top level");
    version_ = shadow_.scene().version();
    return edit;
}

void World::set_transform(std::uint32_t instance) {
    const shading::Instance& data = tables_.instances[instance];
    const std::array<float, 12> columns{data.linear[0].x,   data.linear[0].y,   data.linear[0].z,
                                        data.linear[1].x,   data.linear[1].y,   data.linear[1].z,
                                        data.linear[2].x,   data.linear[2].y,   data.linear[2].z,
                                        data.translation.x, data.translation.y, data.translation.z};
    const RTCGeometry geometry = rtcGetGeometry(top_.get(), instance);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns.data());
    rtcCommitGeometry(geometry);
}

void World::rebuild_top() {
    top_.reset(rtcNewScene(device_));
    rtcSetSceneFlags(top_.get(), RTC_SCENE_FLAG_ROBUST);
    for (std::uint32_t i = 0; i < tables_.instances.size(); ++i) {
        const GeometryHandle geometry(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(geometry.get(),
                                     mesh_scenes_.find(ObjectId{tables_.instances[i].object}));
        rtcSetGeometryTimeStepCount(geometry.get(), 1);
        rtcAttachGeometryByID(top_.get(), geometry.get(), i);
        set_transform(i);
    }
    rtcCommitScene(top_.get());
}

std::uint32_t World::retransform(const backend::SceneDelta& delta) {
    for (const std::uint32_t instance : delta.moved_instances) set_transform(instance);
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

void World::mark_alpha_tested() {
    for (const shading::Instance& instance : tables_.instances) {
        mesh_scenes_.set_alpha_tested(ObjectId{instance.object},
                                      instance.alpha_tested != 0 ? AlphaTest::On : AlphaTest::Off);
    }
}

// Rough transmission is drawn as smooth: told when a material comes to have it.
std::vector<std::string> World::material_problems(const backend::SceneDelta& delta) {
    std::vector<std::string> problems;
    if (delta.everything) told_.clear();
    for (const ObjectId id : delta.materials) {
        const auto* material = shadow_.scene().find_as<scene::Material>(id);
        const bool rough = material != nullptr && material->transmission > 0.0f &&
                           material->metallic < 1.0f &&
                           material->roughness * material->roughness > shading::MinAlpha;
        if (!rough) {
            told_.erase(id);
        } else if (told_.insert(id).second) {
            problems.push_back("material " + std::to_string(id.value) + " '" + material->name +
                               "': its rough transmission is drawn as smooth");
        }
    }
    return problems;
}

backend::EditReport World::report(const backend::SceneDelta& delta,
                                  const backend::MeshCatalog::Result& meshes) {
    backend::EditReport edit{.entries = delta.entries,
                             .relevant = delta.relevant,
                             .rebuilt = meshes.count(backend::MeshStep::Rebuild),
                             .refitted = meshes.count(backend::MeshStep::Refit),
                             .instances = tables_.instances.size(),
                             .lights = tables_.lights.size(),
                             .ignored_kinds = delta.ignored_kinds,
                             .problems = meshes.problems};
    const std::vector<std::string> of_materials = material_problems(delta);
    edit.problems.insert(edit.problems.end(), of_materials.begin(), of_materials.end());
    for (const auto& [id, mesh] : meshes_.all()) {
        edit.triangles += backend::elements<glm::uvec3>(mesh.triangles).size();
        edit.degenerate_triangles += mesh.degenerate_triangles;
    }
    return edit;
}

}  // namespace tessera::embree

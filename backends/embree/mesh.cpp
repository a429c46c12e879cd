#include "backends/embree/mesh.h"

#include <array>

#include "backends/embree/alpha.h"
#include "mediator/scene/validate.h"

namespace tessera::embree {

namespace {

using scene::Geometry;
using Field = Geometry::Field;

// Finds a blob and keeps it alive with the mesh.
template <class T>
std::span<const T> view_of(Mesh& mesh, const scene::BlobStore& blobs, const scene::BlobRef& reference) {
    if (reference.empty()) return {};
    scene::BlobPtr blob = blobs.find(reference.hash);
    if (!blob) return {};
    const auto values = blob->as<T>();
    mesh.blobs.push_back(std::move(blob));
    return values;
}

void resolve_blobs(Mesh& mesh, const scene::BlobStore& blobs) {
    mesh.blobs.clear();
    mesh.positions = view_of<glm::vec3>(mesh, blobs, mesh.source.positions);
    mesh.normals = view_of<glm::vec3>(mesh, blobs, mesh.source.normals);
    mesh.tangents = view_of<glm::vec4>(mesh, blobs, mesh.source.tangents);
    mesh.colors = view_of<glm::vec4>(mesh, blobs, mesh.source.colors);
    mesh.tex_coords = view_of<glm::vec2>(mesh, blobs, mesh.source.tex_coords);
    mesh.triangles = view_of<glm::uvec3>(mesh, blobs, mesh.source.indices);
}

// Shown instead of what cannot be drawn: a box of 1 m at the object's place.
scene::BlobPtr placeholder_positions() {
    std::array<glm::vec3, 8> corners;
    for (unsigned i = 0; i < 8; ++i) {
        corners[i] = glm::vec3((i & 1u) ? 0.5f : -0.5f, (i & 2u) ? 0.5f : -0.5f, (i & 4u) ? 0.5f : -0.5f);
    }
    return std::make_shared<const scene::Blob>(std::as_bytes(std::span(corners)));
}
scene::BlobPtr placeholder_triangles() {
    static constexpr std::array<std::uint32_t, 36> Indices{0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6,
                                                           0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7,
                                                           0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    return std::make_shared<const scene::Blob>(std::as_bytes(std::span(Indices)));
}

std::uint64_t count_degenerate(const Mesh& mesh) {
    std::uint64_t count = 0;
    for (const glm::uvec3& t : mesh.triangles) {
        // In double: tiny triangles are small, not degenerate.
        const glm::dvec3 a = mesh.positions[t.x], b = mesh.positions[t.y], c = mesh.positions[t.z];
        const glm::dvec3 n = glm::cross(b - a, c - a);
        count += glm::dot(n, n) > 0.0 ? 0 : 1;
    }
    return count;
}

}  // namespace

const Mesh* MeshStore::find(ObjectId id) const {
    const auto place = meshes_.find(id);
    return place == meshes_.end() ? nullptr : place->second.get();
}

MeshStore::Result MeshStore::update(const scene::Scene& scene, const backend::SceneDelta& delta) {
    Result result;
    if (delta.everything) meshes_.clear();
    for (const ObjectId id : delta.removed_geometries) meshes_.erase(id);
    for (const auto& change : delta.geometries) {
        const auto* geometry = scene.find_as<Geometry>(change.id);
        if (geometry == nullptr) continue;
        const auto place = meshes_.find(change.id);
        const scene::Fields<Geometry> shape{Field::Hint, Field::Indices, Field::Positions};
        if (place != meshes_.end() && !place->second->placeholder) {
            Mesh& mesh = *place->second;
            const auto broken = scene::validate_blobs(change.id, *scene.find(change.id), *blobs_);
            if (broken.empty() && !change.fields.intersects(shape)) {
                mesh.source = *geometry;  // shading data only
                resolve_blobs(mesh, *blobs_);
                continue;
            }
            if (broken.empty() && mesh.refits && refit(mesh, *geometry)) {
                ++result.refitted;
                continue;
            }
        }
        meshes_[change.id] = build(change.id, *geometry, result.problems);
        ++result.rebuilt;
    }
    check(device_, "building meshes");
    return result;
}

std::unique_ptr<Mesh> MeshStore::build(ObjectId id, const Geometry& geometry,
                                       std::vector<std::string>& problems) {
    auto mesh = std::make_unique<Mesh>();
    mesh->source = geometry;
    for (const scene::Problem& problem : scene::validate_blobs(id, scene::Object(geometry), *blobs_)) {
        mesh->placeholder = true;
        problems.push_back(problem.message + " (a placeholder is drawn instead)");
    }
    resolve_blobs(*mesh, *blobs_);
    if (mesh->placeholder) {
        mesh->normals = {};
        mesh->tangents = mesh->colors = {};
        mesh->tex_coords = {};
        mesh->blobs = {placeholder_positions(), placeholder_triangles()};
        mesh->positions = mesh->blobs[0]->as<glm::vec3>();
        mesh->triangles = mesh->blobs[1]->as<glm::uvec3>();
    }
    mesh->degenerate_triangles = count_degenerate(*mesh);
    mesh->refits = geometry.hint == scene::MotionHint::Animated;
    mesh->scene.reset(rtcNewScene(device_));
    rtcSetSceneFlags(mesh->scene.get(),
                     mesh->refits ? RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC : RTC_SCENE_FLAG_ROBUST);
    const GeometryHandle handle(rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE));
    mesh->geometry = handle.get();
    rtcSetGeometryBuildQuality(handle.get(),
                               mesh->refits ? RTC_BUILD_QUALITY_REFIT : RTC_BUILD_QUALITY_MEDIUM);
    rtcSetSharedGeometryBuffer(handle.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh->triangles.data(), 0, sizeof(glm::uvec3), mesh->triangles.size());
    attach_vertices(*mesh);
    rtcCommitGeometry(handle.get());
    rtcAttachGeometryByID(mesh->scene.get(), handle.get(), 0);
    rtcCommitScene(mesh->scene.get());
    return mesh;
}

void MeshStore::attach_vertices(Mesh& mesh) {
    rtcSetSharedGeometryBuffer(mesh.geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.positions.data(), 0, sizeof(glm::vec3), mesh.positions.size());
}

// Same triangles, other places: the tree stays, its boxes follow.
bool MeshStore::refit(Mesh& mesh, const Geometry& geometry) {
    if (geometry.indices != mesh.source.indices || geometry.hint != mesh.source.hint ||
        geometry.positions.byte_size != mesh.source.positions.byte_size) {
        return false;
    }
    mesh.source = geometry;
    resolve_blobs(mesh, *blobs_);
    mesh.degenerate_triangles = count_degenerate(mesh);
    attach_vertices(mesh);
    // The same blob may be under another address by now.
    rtcSetSharedGeometryBuffer(mesh.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(glm::uvec3), mesh.triangles.size());
    rtcUpdateGeometryBuffer(mesh.geometry, RTC_BUFFER_TYPE_VERTEX, 0);
    rtcCommitGeometry(mesh.geometry);
    rtcCommitScene(mesh.scene.get());
    return true;
}

void MeshStore::set_alpha_tested(ObjectId id, AlphaTest test) {
    Mesh& mesh = *meshes_.at(id);
    const bool wanted = test == AlphaTest::On;
    if (mesh.alpha_tested == wanted) return;
    mesh.alpha_tested = wanted;
    rtcSetGeometryIntersectFilterFunction(mesh.geometry, wanted ? alpha_filter : nullptr);
    rtcSetGeometryOccludedFilterFunction(mesh.geometry, wanted ? alpha_filter : nullptr);
    rtcCommitGeometry(mesh.geometry);
    rtcCommitScene(mesh.scene.get());
}

}  // namespace tessera::embree

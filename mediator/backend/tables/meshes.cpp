#include "mediator/backend/tables/meshes.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "mediator/scene/validate.h"

namespace tessera::backend {

namespace {

using scene::Geometry;

void resolve_blobs(Mesh& mesh, const scene::BlobStore& blobs) {
    const auto find = [&](const scene::BlobRef& reference) {
        return reference.empty() ? scene::BlobPtr() : blobs.find(reference.hash);
    };
    mesh.positions = find(mesh.source.positions);
    mesh.normals = find(mesh.source.normals);
    mesh.tangents = find(mesh.source.tangents);
    mesh.colors = find(mesh.source.colors);
    mesh.tex_coords = find(mesh.source.tex_coords);
    mesh.tex_coords_1 = find(mesh.source.tex_coords_1);
    mesh.triangles = find(mesh.source.indices);
    const auto find_all = [&](const std::vector<scene::BlobRef>& references) {
        std::vector<scene::BlobPtr> found;
        for (const scene::BlobRef& reference : references) found.push_back(find(reference));
        return found;
    };
    mesh.motion_positions = find_all(mesh.source.motion_positions);
    mesh.motion_normals = find_all(mesh.source.motion_normals);
}

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

// Bounds and degenerate triangles.
void measure(Mesh& mesh) {
    const auto positions = elements<glm::vec3>(mesh.positions);
    mesh.low = Mesh().low;
    mesh.high = Mesh().high;
    mesh.degenerate_triangles = 0;
    for (const glm::uvec3& t : elements<glm::uvec3>(mesh.triangles)) {
        // In double, so that tiny triangles are not taken for degenerate.
        const glm::dvec3 a = positions[t.x], b = positions[t.y], c = positions[t.z];
        const glm::dvec3 n = glm::cross(b - a, c - a);
        mesh.degenerate_triangles += glm::dot(n, n) > 0.0 ? 0 : 1;
        mesh.low = glm::min(mesh.low, glm::min(positions[t.x], glm::min(positions[t.y], positions[t.z])));
        mesh.high = glm::max(mesh.high, glm::max(positions[t.x], glm::max(positions[t.y], positions[t.z])));
        for (const scene::BlobPtr& step : mesh.motion_positions) {
            const auto moved = elements<glm::vec3>(step);
            for (const std::uint32_t corner : {t.x, t.y, t.z}) {
                mesh.low = glm::min(mesh.low, moved[corner]);
                mesh.high = glm::max(mesh.high, moved[corner]);
            }
        }
    }
}

bool fits(const Mesh& mesh, const Geometry& geometry) {
    return mesh.refits && geometry.motion_positions.empty() && geometry.indices == mesh.source.indices &&
           geometry.hint == mesh.source.hint &&
           geometry.positions.byte_size == mesh.source.positions.byte_size;
}

}  // namespace

std::uint32_t MeshCatalog::Result::count(MeshUpdate step) const {
    return static_cast<std::uint32_t>(std::count_if(
        changes.begin(), changes.end(), [&](const Change& change) { return change.step == step; }));
}

MeshCatalog::Result MeshCatalog::everything() const {
    Result all{.everything = true};
    for (const auto& [id, mesh] : meshes_) all.changes.push_back({id, MeshUpdate::Rebuild});
    return all;
}

const Mesh* MeshCatalog::find(ObjectId id) const {
    const auto it = meshes_.find(id);
    return it == meshes_.end() ? nullptr : &it->second;
}

MeshCatalog::Result MeshCatalog::update(const scene::Scene& scene, const SceneDelta& delta) {
    Result result{.everything = delta.everything, .removed = delta.removed_geometries};
    if (delta.everything) meshes_.clear();
    for (const ObjectId id : delta.removed_geometries) meshes_.erase(id);
    for (const auto& change : delta.geometries) {
        const auto* geometry = scene.find_as<Geometry>(change.id);
        if (geometry == nullptr) continue;
        const auto it = meshes_.find(change.id);
        const scene::Fields<Geometry> shape{&Geometry::hint, &Geometry::indices, &Geometry::positions,
                                            &Geometry::motion_positions};
        MeshUpdate step = MeshUpdate::Rebuild;
        if (it != meshes_.end() && !it->second.placeholder &&
            scene::validate_blobs(change.id, *scene.find(change.id), *blobs_).empty()) {
            if (!change.fields.intersects(shape)) {
                step = MeshUpdate::ShadingData;
            } else if (fits(it->second, *geometry)) {
                step = MeshUpdate::Refit;
            }
        }
        if (step == MeshUpdate::Rebuild) {
            meshes_[change.id] = build(change.id, *geometry, result.problems);
        } else {
            it->second.source = *geometry;
            resolve_blobs(it->second, *blobs_);
            if (step == MeshUpdate::Refit) measure(it->second);
        }
        result.changes.push_back({change.id, step});
    }
    return result;
}

Mesh MeshCatalog::build(ObjectId id, const Geometry& geometry, std::vector<std::string>& problems) const {
    Mesh mesh{.source = geometry,
              .refits = geometry.hint == scene::MotionHint::Animated && geometry.motion_positions.empty()};
    for (const scene::Problem& problem : scene::validate_blobs(id, scene::Object(geometry), *blobs_)) {
        mesh.placeholder = true;
        problems.push_back(problem.message + " (a placeholder is drawn instead)");
    }
    if (mesh.placeholder) {
        mesh.positions = placeholder_positions();
        mesh.triangles = placeholder_triangles();
    } else {
        resolve_blobs(mesh, *blobs_);
    }
    measure(mesh);
    return mesh;
}

}  // namespace tessera::backend

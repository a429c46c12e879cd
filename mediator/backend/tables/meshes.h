#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <limits>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "mediator/backend/shadow_scene.h"

namespace tessera::backend {

// The arrays of one geometry, where they lie in their blobs; null = not there. A geometry whose blobs cannot
// be drawn has a placeholder's: a box of 1 m at the object's place.
struct Mesh {
    scene::Geometry source;
    scene::BlobPtr positions, normals, tangents, colors, tex_coords, tex_coords_1, triangles;
    std::vector<scene::BlobPtr> motion_positions, motion_normals;  // as scene::Geometry
    glm::vec3 low{std::numeric_limits<float>::infinity()};         // bounds of what can be hit, at any time;
    glm::vec3 high{-std::numeric_limits<float>::infinity()};       // low > high: nothing
    std::uint64_t degenerate_triangles = 0;
    bool refits =
        false;  // its structure is built for updates in place; none is that moves within the shutter
    bool placeholder = false;
};

// The elements of an array; none where there is no blob.
template <class T>
std::span<const T> elements(const scene::BlobPtr& blob) {
    return blob ? blob->as<T>() : std::span<const T>{};
}

// What an edit asks of a mesh's acceleration structure.
enum class MeshStep {
    ShadingData,  // nothing: the triangles are where they were
    Refit,        // same triangles, vertices at other places
    Rebuild,      // it is new, or has other triangles
};

// All meshes by geometry id, in step with the scene. What an edit does to each is decided here, for all
// back-ends alike.
class MeshCatalog {
  public:
    explicit MeshCatalog(std::shared_ptr<const scene::BlobStore> blobs) : blobs_(std::move(blobs)) {}

    struct Change {
        ObjectId id;
        MeshStep step;
    };
    struct Result {
        bool everything = false;        // no mesh of before counts
        std::vector<ObjectId> removed;  // may name some that were never there
        std::vector<Change> changes;
        std::vector<std::string> problems;  // of placeholders

        std::uint32_t count(MeshStep step) const;
    };
    Result update(const scene::Scene& scene, const SceneDelta& delta);

    const Mesh* find(ObjectId id) const;
    const std::map<ObjectId, Mesh>& all() const { return meshes_; }

  private:
    Mesh build(ObjectId id, const scene::Geometry& geometry, std::vector<std::string>& problems) const;

    std::shared_ptr<const scene::BlobStore> blobs_;
    std::map<ObjectId, Mesh> meshes_;
};

}  // namespace tessera::backend

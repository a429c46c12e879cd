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

// The arrays of one geometry, as blobs; null = absent. A geometry with invalid blobs gets those of a placeholder: a
// box of 1 m at the object's origin.
struct Mesh {
    scene::Geometry source;
    scene::BlobPtr positions, normals, tangents, colors, tex_coords, tex_coords_1, triangles;
    std::vector<scene::BlobPtr> motion_positions, motion_normals;  // as scene::Geometry
    glm::vec3 low{std::numeric_limits<float>::infinity()};    // bounds of its triangles over the shutter;
    glm::vec3 high{-std::numeric_limits<float>::infinity()};  // low > high: empty
    std::uint64_t degenerate_triangles = 0;
    bool refits = false;  // its BVH is built for refitting; never with motion keys
    bool placeholder = false;
};

// The elements of an array; empty without a blob.
template <class T>
std::span<const T> elements(const scene::BlobPtr& blob) {
    return blob ? blob->as<T>() : std::span<const T>{};
}

// How an edit affects a mesh's acceleration structure.
enum class MeshUpdate {
    ShadingData,  // not at all: positions and triangles are unchanged
    Refit,        // same triangles, other vertex positions
    Rebuild,      // a new mesh, or other triangles
};

// All meshes by geometry id, updated with the scene. Decides for all back-ends how an edit affects each of them.
class MeshCatalog {
  public:
    explicit MeshCatalog(std::shared_ptr<const scene::BlobStore> blobs) : blobs_(std::move(blobs)) {}

    struct Change {
        ObjectId id;
        MeshUpdate step;
    };
    struct Result {
        bool everything = false;        // all previous meshes are gone
        std::vector<ObjectId> removed;  // may contain unknown ids
        std::vector<Change> changes;
        std::vector<std::string> problems;  // of placeholders

        std::uint32_t count(MeshUpdate step) const;
    };
    Result update(const scene::Scene& scene, const SceneDelta& delta);

    Result everything() const;  // all meshes, as if they were new

    const Mesh* find(ObjectId id) const;
    const std::map<ObjectId, Mesh>& all() const { return meshes_; }

  private:
    Mesh build(ObjectId id, const scene::Geometry& geometry, std::vector<std::string>& problems) const;

    std::shared_ptr<const scene::BlobStore> blobs_;
    std::map<ObjectId, Mesh> meshes_;
};

}  // namespace tessera::backend

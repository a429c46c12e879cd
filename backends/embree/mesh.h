#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "backends/embree/device.h"
#include "mediator/backend/shadow_scene.h"

namespace tessera::embree {

// One geometry with its own bottom-level structure, shared by all its instances. Vertex data stay in their
// blobs.
struct Mesh {
    scene::Geometry source;
    std::vector<scene::BlobPtr> blobs;  // keep the spans alive
    std::span<const glm::vec3> positions, normals;
    std::span<const glm::vec4> tangents, colors;
    std::span<const glm::vec2> tex_coords;
    std::span<const glm::uvec3> triangles;
    std::uint64_t degenerate_triangles = 0;
    bool refits = false;  // built for updates in place
    bool placeholder = false;
    bool alpha_tested = false;
    SceneHandle scene;
    RTCGeometry geometry = nullptr;  // owned by the scene
};

enum class AlphaTest { Off, On };

// All meshes by object id. What an edit does to one is decided here: nothing, refit or rebuild.
class MeshStore {
  public:
    MeshStore(RTCDevice device, std::shared_ptr<scene::BlobStore> blobs)
        : device_(device), blobs_(std::move(blobs)) {}

    struct Result {
        std::uint32_t rebuilt = 0, refitted = 0;
        std::vector<std::string> problems;
    };
    Result update(const scene::Scene& scene, const backend::SceneDelta& delta);
    void set_alpha_tested(ObjectId id, AlphaTest test);  // whether rays ask the filter in alpha.h

    const Mesh* find(ObjectId id) const;
    const std::map<ObjectId, std::unique_ptr<Mesh>>& all() const { return meshes_; }

  private:
    std::unique_ptr<Mesh> build(ObjectId id, const scene::Geometry& geometry,
                                std::vector<std::string>& problems);
    bool refit(Mesh& mesh, const scene::Geometry& geometry);
    void attach_vertices(Mesh& mesh);

    RTCDevice device_;
    std::shared_ptr<scene::BlobStore> blobs_;
    std::map<ObjectId, std::unique_ptr<Mesh>> meshes_;
};

}  // namespace tessera::embree

#include <algorithm>
#include <unordered_map>

#include "client/import/x3d_smoothing.h"

namespace tessera::import {
namespace {

struct CornerHash {
    std::size_t operator()(const FaceSet::Corner& corner) const {
        std::uint64_t hash = 0;
        for (const std::uint32_t part : {corner.position, corner.normal, corner.color, corner.tex_coord})
            hash = (hash ^ part) * 0x9e3779b97f4a7c15ull + (hash >> 29);
        return hash;
    }
};

class VertexWelder {
  public:
    explicit VertexWelder(const FaceSet& faces) : faces_(faces) {}

    std::uint32_t vertex(const FaceSet::Corner& corner) {
        const auto [entry, is_new] =
            vertices_.try_emplace(corner, static_cast<std::uint32_t>(mesh_.positions.size()));
        if (is_new) {
            mesh_.positions.push_back(faces_.positions[corner.position]);
            if (corner.normal != FaceSet::None) mesh_.normals.push_back(faces_.normals[corner.normal]);
            if (corner.color != FaceSet::None) mesh_.colors.push_back(faces_.colors[corner.color]);
            if (corner.tex_coord != FaceSet::None)
                mesh_.tex_coords.push_back(faces_.tex_coords[corner.tex_coord]);
        }
        return entry->second;
    }

    MeshData& mesh() { return mesh_; }

  private:
    const FaceSet& faces_;
    MeshData mesh_;
    std::unordered_map<FaceSet::Corner, std::uint32_t, CornerHash> vertices_;
};

}  // namespace

MeshData mesh_of(FaceSet faces) {
    if (faces.normals.empty() && faces.crease_angle > 0.0) add_smooth_normals(faces);
    VertexWelder welder(faces);
    std::vector<glm::vec3> outline;
    std::size_t first = 0;
    for (const std::size_t end : faces.ends) {
        outline.clear();
        for (std::size_t i = first; i < end; ++i)
            outline.push_back(faces.positions[faces.corners[i].position]);
        for (std::array<std::uint32_t, 3> triangle : triangles_of_polygon(outline, faces.shape)) {
            if (!faces.counter_clockwise) std::swap(triangle[1], triangle[2]);
            for (const std::uint32_t corner : triangle)
                welder.mesh().indices.push_back(welder.vertex(faces.corners[first + corner]));
        }
        first = end;
    }
    return std::move(welder.mesh());
}

}  // namespace tessera::import

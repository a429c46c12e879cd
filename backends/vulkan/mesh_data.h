#pragma once

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "mediator/backend/tables/meshes.h"

namespace tessera::vulkan {

inline MeshData data_of(const backend::Mesh& mesh) {
    MeshData data{backend::elements<glm::vec3>(mesh.positions),
                  backend::elements<glm::uvec3>(mesh.triangles)};
    for (const scene::BlobPtr& step : mesh.motion_positions) {
        data.later_positions.push_back(backend::elements<glm::vec3>(step));
    }
    return data;
}

}  // namespace tessera::vulkan

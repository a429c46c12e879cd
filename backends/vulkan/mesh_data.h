#pragma once

#include "backends/vulkan/bvh/mesh_bvh.h"
#include "mediator/backend/tables/meshes.h"

namespace tessera::vulkan {

inline MeshData data_of(const backend::Mesh& mesh) {
    return {backend::elements<glm::vec3>(mesh.positions), backend::elements<glm::uvec3>(mesh.triangles)};
}

}  // namespace tessera::vulkan

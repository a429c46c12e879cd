#pragma once

#include <map>
#include <span>
#include <string>

#include "client/import/deform.h"

namespace tessera::import {

// KHR_draco_mesh_compression: triangles and the attributes POSITION, NORMAL, TANGENT, COLOR_0, TEXCOORD_0 and
// TEXCOORD_1 of a compressed mesh, and its joint sets (JOINTS_n and WEIGHTS_n, not normalized), by the unique
// ids in the extension. `most_faces` is what the indices' accessor states; the extension demands the same count,
// but some encoders leave out degenerate triangles, and others split vertices without counting them. Throws
// Error{InvalidInput}.
struct DracoMesh {
    MeshData mesh;
    std::vector<JointSet> sets;
};
DracoMesh decode_draco(std::span<const unsigned char> bytes, const std::map<std::string, int>& attribute_ids,
                       std::uint64_t most_faces);

}  // namespace tessera::import

#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "client/import/mesh_data.h"

namespace tessera::import {

// Offsets per unit weight; each array is empty or has one element per vertex.
struct MorphTarget {
    std::vector<glm::vec3> positions, normals, tangents;
};

// Up to four joints per vertex; a mesh with more has several sets.
struct JointSet {
    std::vector<glm::u16vec4> joints;
    std::vector<glm::vec4> weights;  // sum to 1 per vertex, over all sets
};

// A mesh with morph targets or a skin. The arrays of targets and sets are parallel to the vertices of `rest`.
struct DeformableMesh {
    MeshData rest;
    std::vector<MorphTarget> targets;
    std::vector<JointSet> sets;   // empty = no skin
    std::size_t joint_count = 0;  // the largest joint index + 1
    bool is_flat = false;         // flat shading: triangles share no vertices
};

// Divides weights by their sum per vertex; where it is 0, the first joint gets weight 1.
// Throws Error{InvalidInput} for weights that are negative or not finite.
void normalize_weights(std::vector<JointSet>& sets);

// Adapts targets and sets after vertices were duplicated: vertex i was from[i].
void remap_vertices(DeformableMesh& mesh, std::span<const std::uint32_t> from);

// Applies morph targets (missing weights are 0), then linear blend skinning. Normals are transformed by the
// inverse transpose, tangents as directions, both normalized. Flat normals are recomputed. If there are joint
// sets, `joints` must have at least joint_count matrices. Throws Error{InvalidInput} if a position is not
// finite.
MeshData deform(const DeformableMesh& mesh, std::span<const double> weights,
                std::span<const glm::dmat4> joints);

}  // namespace tessera::import

#pragma once

#include <glm/gtc/type_precision.hpp>
#include <glm/mat4x4.hpp>
#include <span>
#include <vector>

#include "client/import/mesh_data.h"

namespace tessera::import {

// What a weight adds to a mesh; arrays are empty or have one difference per vertex.
struct MorphTarget {
    std::vector<glm::vec3> positions, normals, tangents;
};

// Up to four joints of each vertex; a mesh with more has several of these.
struct JointSet {
    std::vector<glm::u16vec4> joints;
    std::vector<glm::vec4> weights;  // over all sets of a vertex they sum to 1
};

// A mesh that bends. All arrays of targets and sets follow the vertices of `rest`.
struct BendingMesh {
    MeshData rest;
    std::vector<MorphTarget> targets;
    std::vector<JointSet> sets;   // none = no skin
    std::size_t joint_count = 0;  // one more than the largest joint
    bool is_flat = false;         // each triangle has three vertices of its own and its own normal
};

// Brings joints to use: weights are divided by their sum per vertex; where it is 0 the first joint has all.
// Throws Error{InvalidInput} for weights that are negative or not finite.
void normalize_weights(std::vector<JointSet>& sets);

// Targets and sets follow vertices that were spread or split: vertex i was from[i].
void follow(BendingMesh& mesh, std::span<const std::uint32_t> from);

// `rest` with positions, normals and tangents bent: first the targets by their weights (those without one
// count as 0), then the joints by linear blending; normals by the inverse transpose, tangents as directions,
// both of length 1. Flat normals are made anew. `joints` has joint_count matrices at least, where there are
// sets. Throws Error{InvalidInput} when a position is not finite.
MeshData bend(const BendingMesh& mesh, std::span<const double> weights, std::span<const glm::dmat4> joints);

}  // namespace tessera::import

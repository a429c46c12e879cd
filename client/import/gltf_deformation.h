#pragma once

#include "client/import/deform.h"
#include "client/import/gltf_accessor.h"
#include "client/import/node_motion.h"
#include "client/import/scene_builder.h"

namespace tinygltf {
struct Mesh;
struct Primitive;
}  // namespace tinygltf

namespace tessera::import {

enum class Joints { Used, Ignored };

// Reads the morph targets of a primitive of `vertices` vertices and, if used, its joints: those decoded from
// a compressed mesh, else from its accessors. Throws Error{InvalidInput} for arrays of the wrong length,
// values that are not finite and invalid weights.
DeformableMesh read_deformation(const tinygltf::Primitive& primitive, std::size_t vertices, Joints joints,
                                std::vector<JointSet> decoded, const GltfAccessors& accessors,
                                SceneBuilder& builder);

std::size_t target_count(const tinygltf::Mesh& mesh);  // of the first primitive
bool has_joints(const tinygltf::Mesh& mesh);           // of all primitives

// Joints, which must be `reached` nodes, and inverse bind matrices. Throws Error{InvalidInput} if joints are
// missing or not in the scene, if there are fewer matrices than joints, or if a matrix is not finite.
Skin read_skin(const tinygltf::Model& model, int skin, const std::vector<MovingNode>& nodes,
               const std::vector<bool>& reached);

}  // namespace tessera::import

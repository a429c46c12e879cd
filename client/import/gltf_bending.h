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

// The morph targets of a primitive of `vertices` vertices and, where they are used, its joints: those that
// were decoded with a compressed mesh, else those of its accessors. Throws Error{InvalidInput}: arrays of
// other lengths or not finite, weights that are no weights.
BendingMesh read_bending(const tinygltf::Primitive& primitive, std::size_t vertices, Joints joints,
                         std::vector<JointSet> decoded, const GltfAccessors& accessors,
                         SceneBuilder& builder);

std::size_t target_count(const tinygltf::Mesh& mesh);  // of its first primitive
bool has_joints(const tinygltf::Mesh& mesh);           // all of its primitives

// The joints among `reached` nodes, with their matrices as bound. Throws Error{InvalidInput}: joints that are
// missing or not drawn, fewer matrices than joints, matrices that are not finite.
Skin read_skin(const tinygltf::Model& model, int skin, const std::vector<MovingNode>& nodes,
               const std::vector<bool>& reached);

}  // namespace tessera::import

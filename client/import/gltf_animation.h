#pragma once

#include "client/import/node_motion.h"
#include "client/import/scene_builder.h"

namespace tinygltf {
class Model;
}

namespace tessera::import {

// Names and durations of all animations of the file, also those that cannot be played; 0 without keys.
std::vector<AnimationInfo> list_animations(const tinygltf::Model& model, SceneBuilder& builder);

// Sets the tracks of the nodes from all animations, or from the one named in the options. If several
// animations target the same property of a node, the first one is used. Invalid channels are skipped, each
// with a notice. Throws Error{InvalidInput} if the named animation does not exist; the message lists those
// there are.
void read_animations(const tinygltf::Model& model, const std::vector<bool>& reached, SceneBuilder& builder,
                     NodeMotion& motion);

}  // namespace tessera::import

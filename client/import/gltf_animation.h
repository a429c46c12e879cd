#pragma once

#include "client/import/node_motion.h"
#include "client/import/scene_builder.h"

namespace tinygltf {
class Model;
}

namespace tessera::import {

// Names and lengths of a file's animations, whether they can be played or not; one without keys has length 0.
std::vector<AnimationInfo> survey_animations(const tinygltf::Model& model, SceneBuilder& builder);

// Gives the nodes their tracks: of all animations together, or of the one that the options name. Where two
// move the same property of a node, the first does. Channels that cannot be played are left out, each with a
// notice. Throws Error{InvalidInput} when there is no such animation; the message lists those there are.
void read_animations(const tinygltf::Model& model, const std::vector<bool>& reached, SceneBuilder& builder,
                     NodeMotion& motion);

}  // namespace tessera::import

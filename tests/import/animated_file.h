#pragma once

#include "tests/import/scene_file.h"

namespace tessera::import {

// An animation with one channel; keys are accessor indices.
std::string animation(const std::string& name, int input, int output, int node, const std::string& path,
                      const std::string& interpolation = "LINEAR");

// All kinds of animation in one file; the mesh "arm" is a quad:
//   node 0 "cart"     moves by 10 m along x from 0 s to 2 s
//   node 1 "body"     in it: the mesh, skinned; its own translation of 1000 m is to be ignored
//   node 2 "shoulder" in it: a joint
//   node 3 "hand"     in the shoulder, 1 m above: a joint, turns by 90 degrees about z from 0 s to 1 s
//   node 4 "eye"      in the cart: a camera 5 m before it
//   node 5 "face"     at the root: a mesh of one triangle and one morph target, whose weight goes 0, 1, 0 at
//                     0 s, 1 s and 2 s
//   node 6 "flag"     at the root: the triangle without morphing; its scale is 0 at 0 s and 1 at 2 s
// The quad extends from (0, 0) to (1, 2); its lower corners follow the shoulder, its upper ones the hand,
// bound in the rest pose. The target moves the triangle's (0, 1, 0) by (0, 0, 3).
SceneFile moving_file();

}  // namespace tessera::import

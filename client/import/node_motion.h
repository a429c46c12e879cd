#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/import/keyframes.h"

namespace tessera::import {

// A node of a file: where it is in its parent, and which tracks move it.
struct MovingNode {
    std::string name;
    int parent = -1;              // index of a node; -1 = it hangs from the root
    glm::dmat4 rest{1.0};         // parent from local
    std::vector<double> weights;  // of its mesh's morph targets, at rest
    int translation_track = -1, rotation_track = -1, scale_track = -1, weights_track = -1;
    glm::dvec3 translation{0.0};  // what rest is made of, where a track moves the node
    glm::dvec4 rotation{0.0, 0.0, 0.0, 1.0};
    glm::dvec3 scale{1.0};

    bool moves() const { return translation_track >= 0 || rotation_track >= 0 || scale_track >= 0; }
};

// Where all nodes are at one time.
struct Pose {
    std::vector<glm::dmat4> local;             // parent from local, of each node
    std::vector<std::vector<double>> weights;  // of each node
};

struct NodeMotion {
    std::vector<MovingNode> nodes;
    std::vector<KeyTrack> tracks;  // checked

    // Without a time at rest. Throws Error{InvalidInput}, which names the node, when a track leads to no
    // transform.
    Pose pose(std::optional<double> seconds) const;
};

// A skin binds vertices to nodes. `anchor` is the node next above all joints (-1 = the root): vertices are
// posed in its frame, so that what moves the anchor moves no vertex.
struct Skin {
    int anchor = -1;
    std::vector<int> joints;
    std::vector<glm::dmat4> inverse_binds;  // joint from vertex, as bound; one per joint
};

// The lowest node that is above all of them and none of them; -1 = only the root is. The parents have no
// cycles.
int anchor_of(const std::vector<int>& joints, const std::vector<MovingNode>& nodes);

// Anchor from vertex, one per joint. The transform of the node with the mesh plays no part
// (glTF 2.0, 3.7.3.3).
std::vector<glm::dmat4> joint_matrices(const Skin& skin, const std::vector<MovingNode>& nodes,
                                       const Pose& pose);

}  // namespace tessera::import

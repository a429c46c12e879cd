#pragma once

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <optional>
#include <string>
#include <vector>

#include "client/import/keyframes.h"

namespace tessera::import {

// A node of a file: its transform, and the tracks that animate it.
struct MovingNode {
    std::string name;
    int parent = -1;              // index of a node; -1 = the root
    glm::dmat4 rest{1.0};         // parent from local
    std::vector<double> weights;  // of its mesh's morph targets, in the rest pose
    int translation_track = -1, rotation_track = -1, scale_track = -1, weights_track = -1;
    glm::dvec3 translation{0.0};  // components of `rest`, if a track animates the node
    glm::dvec4 rotation{0.0, 0.0, 0.0, 1.0};
    glm::dvec3 scale{1.0};

    bool moves() const { return translation_track >= 0 || rotation_track >= 0 || scale_track >= 0; }
};

// The pose of all nodes at one time.
struct Pose {
    std::vector<glm::dmat4> local;             // parent from local, of each node
    std::vector<std::vector<double>> weights;  // of each node
};

struct NodeMotion {
    std::vector<MovingNode> nodes;
    std::vector<KeyTrack> tracks;  // checked

    // Without a time: the rest pose. Throws Error{InvalidInput} naming the node if a track gives an invalid
    // transform.
    Pose pose(std::optional<double> seconds) const;
};

// A skin binds vertices to nodes. `skeleton_root` is the lowest common ancestor of the joints (-1 = the scene
// root). Vertices are posed in its frame, so that moving the skeleton root does not change them.
struct Skin {
    int skeleton_root = -1;
    std::vector<int> joints;
    std::vector<glm::dmat4> inverse_binds;  // inverse bind matrices: joint from vertex; one per joint
};

// The lowest common ancestor that is none of the joints; -1 = the scene root. The parents must have no
// cycles.
int skeleton_root_of(const std::vector<int>& joints, const std::vector<MovingNode>& nodes);

// Skeleton root from vertex, one per joint. The transform of the node with the mesh is ignored (glTF 2.0,
// 3.7.3.3).
std::vector<glm::dmat4> joint_matrices(const Skin& skin, const std::vector<MovingNode>& nodes,
                                       const Pose& pose);

}  // namespace tessera::import

#include "client/import/node_motion.h"

#include <array>
#include <unordered_map>

#include "client/import/gltf_placement.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

const KeyTrack* track_of(const NodeMotion& motion, int track) {
    return track < 0 ? nullptr : &motion.tracks[static_cast<std::size_t>(track)];
}

glm::dvec3 vector_at(const KeyTrack* track, double seconds, const glm::dvec3& rest) {
    if (track == nullptr) return rest;
    std::array<double, 3> value;
    sample(*track, seconds, value);
    return {value[0], value[1], value[2]};
}

glm::dmat4 moved(const NodeMotion& motion, const MovingNode& node, double seconds) {
    const KeyTrack* turn = track_of(motion, node.rotation_track);
    const auto matrix =
        placement(vector_at(track_of(motion, node.translation_track), seconds, node.translation),
                  turn == nullptr ? node.rotation : sample_rotation(*turn, seconds),
                  vector_at(track_of(motion, node.scale_track), seconds, node.scale));
    if (matrix) return *matrix;
    throw Error(ErrorCode::InvalidInput, "node '" + node.name + "' at " + std::to_string(seconds) +
                                             " s: " + matrix.error().what() + "; repair its animation");
}

const MovingNode& at(const std::vector<MovingNode>& nodes, int index) {
    return nodes[static_cast<std::size_t>(index)];
}

}  // namespace

Pose NodeMotion::pose(std::optional<double> seconds) const {
    Pose pose;
    pose.local.reserve(nodes.size());
    pose.weights.reserve(nodes.size());
    for (const MovingNode& node : nodes) {
        pose.local.push_back(seconds && node.moves() ? moved(*this, node, *seconds) : node.rest);
        pose.weights.push_back(node.weights);
        if (const KeyTrack* track = track_of(*this, node.weights_track); track != nullptr && seconds) {
            pose.weights.back().resize(track->width);
            sample(*track, *seconds, pose.weights.back());
        }
    }
    return pose;
}

int skeleton_root_of(const std::vector<int>& joints, const std::vector<MovingNode>& nodes) {
    std::unordered_map<int, std::size_t> above;  // ancestors of the first joint, with their distance
    std::vector<int> line;                       // from the first joint's parent up to the root
    for (int node = at(nodes, joints.front()).parent; node >= 0; node = at(nodes, node).parent) {
        above[node] = line.size();
        line.push_back(node);
    }
    std::size_t lowest = 0;
    for (const int joint : joints) {
        int node = at(nodes, joint).parent;
        while (node >= 0 && !above.contains(node)) node = at(nodes, node).parent;
        lowest = std::max(lowest, node < 0 ? line.size() : above.at(node));
    }
    // A joint may be an ancestor of others.
    for (const int joint : joints) {
        const auto entry = above.find(joint);
        if (entry != above.end()) lowest = std::max(lowest, entry->second + 1);
    }
    return lowest < line.size() ? line[lowest] : -1;
}

std::vector<glm::dmat4> joint_matrices(const Skin& skin, const std::vector<MovingNode>& nodes,
                                       const Pose& pose) {
    std::unordered_map<int, glm::dmat4> known{
        {skin.skeleton_root, glm::dmat4(1.0)}};  // skeleton root from node
    std::vector<int> line;
    std::vector<glm::dmat4> matrices;
    matrices.reserve(skin.joints.size());
    for (std::size_t i = 0; i < skin.joints.size(); ++i) {
        int node = skin.joints[i];
        for (; !known.contains(node); node = at(nodes, node).parent) line.push_back(node);
        glm::dmat4 matrix = known.at(node);
        for (; !line.empty(); line.pop_back()) {
            matrix = matrix * pose.local[static_cast<std::size_t>(line.back())];
            known.emplace(line.back(), matrix);
        }
        matrices.push_back(matrix * skin.inverse_binds[i]);
    }
    return matrices;
}

}  // namespace tessera::import

#pragma once

#include <map>
#include <optional>
#include <vector>

#include "client/import/gltf_meshes.h"
#include "client/import/playback.h"

namespace tinygltf {
class Model;
}

namespace tessera::import {

// Poses the nodes of the scene at the time in the options, deforms their meshes, and keeps what move_to needs
// for other times. Invalid animations and skins are skipped with a notice.
class GltfMotion {
  public:
    // `children`: of each node of the scene.
    GltfMotion(const tinygltf::Model& model, SceneBuilder& builder,
               const std::map<int, std::vector<int>>& children);

    const MovingNode& node(int index) const {
        return playback_.motion.nodes[static_cast<std::size_t>(index)];
    }
    const glm::dmat4& local(int index) const { return pose_.local[static_cast<std::size_t>(index)]; }

    // The skeleton root of the skin of the node's mesh; none without a skin. -1 is the scene root.
    std::optional<int> skeleton_root(int index) const;
    std::uint32_t own_layers(int index) const { return layers_[static_cast<std::size_t>(index)]; }
    std::uint32_t layers(
        int index) const;  // of the node or the nearest ancestor that has some; -1: the scene root's

    bool deforms(int index) const;
    // The geometries of a node with a deformed mesh.
    std::vector<ObjectId> deformed_geometries(int index, GltfMeshes& meshes);

    void set_transform(int index, ObjectId transform) {
        playback_.transforms[static_cast<std::size_t>(index)] = transform;
    }
    bool has_transform(int index) const {
        return static_cast<bool>(playback_.transforms[static_cast<std::size_t>(index)]);
    }
    void set_layers(int index, std::uint32_t layers) { layers_[static_cast<std::size_t>(index)] = layers; }
    void
    keep_playback();  // for move_to, if the options ask for it and something is animated; sets motion hints

  private:
    bool keeps_playback() const;  // whether the options ask for other times
    void read_transform(int index);
    void read_skin_of(int index);
    bool is_animated(int index, int end) const;  // from the node up to, but excluding, `end`

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    std::vector<bool> reachable_;
    std::vector<std::uint32_t> layers_;
    Playback playback_;
    Pose pose_;
    std::map<int, int> skins_;         // file's index to that in playback_, -1 = invalid
    std::map<int, int> skin_of_node_;  // index in playback_
};

}  // namespace tessera::import

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

// Where the nodes that are drawn are at the time the options ask for, how they bend their meshes, and what of
// it is kept for other times. Bad animations and skins are left out, with a notice.
class GltfMotion {
  public:
    // `children` of each node that is drawn.
    GltfMotion(const tinygltf::Model& model, SceneBuilder& builder,
               const std::map<int, std::vector<int>>& children);

    const MovingNode& node(int index) const {
        return playback_.motion.nodes[static_cast<std::size_t>(index)];
    }
    const glm::dmat4& local(int index) const { return pose_.local[static_cast<std::size_t>(index)]; }

    // Of the skin that poses the node's mesh; nothing where none does. -1 is the root.
    std::optional<int> anchor(int index) const;
    std::uint32_t own_layers(int index) const { return layers_[static_cast<std::size_t>(index)]; }
    std::uint32_t layers(
        int index) const;  // of the node or the nearest above that names some; -1: the root's

    bool bends(int index) const;
    // The geometries of a node that bends its mesh.
    std::vector<ObjectId> bent_geometries(int index, GltfMeshes& meshes);

    void set_transform(int index, ObjectId transform) {
        playback_.transforms[static_cast<std::size_t>(index)] = transform;
    }
    bool has_transform(int index) const {
        return static_cast<bool>(playback_.transforms[static_cast<std::size_t>(index)]);
    }
    void set_layers(int index, std::uint32_t layers) { layers_[static_cast<std::size_t>(index)] = layers; }
    void keep();  // for move_to, where the options ask for it and something moves; flags what does

  private:
    bool keeps() const;  // what moves, for other times
    void place(int index);
    void read_skin_of(int index);
    bool is_moved(int index, int end) const;  // between a node and one above it

    const tinygltf::Model& model_;
    SceneBuilder& builder_;
    std::vector<bool> reached_;
    std::vector<std::uint32_t> layers_;
    Playback playback_;
    Pose pose_;
    std::map<int, int> skins_;         // file's number to ours, -1 = bad
    std::map<int, int> skin_of_node_;  // ours
};

}  // namespace tessera::import

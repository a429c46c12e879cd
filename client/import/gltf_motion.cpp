#include "client/import/gltf_motion.h"

#include <tiny_gltf.h>

#include <algorithm>

#include "client/import/gltf_animation.h"
#include "client/import/gltf_deformation.h"
#include "client/import/gltf_placement.h"

namespace tessera::import {

GltfMotion::GltfMotion(const tinygltf::Model& model, SceneBuilder& builder,
                       const std::map<int, std::vector<int>>& children)
    : model_(model),
      builder_(builder),
      reachable_(model.nodes.size(), false),
      layers_(model.nodes.size(), 0) {
    playback_.motion.nodes.resize(model.nodes.size());
    playback_.transforms.resize(model.nodes.size());
    for (const auto& [index, below] : children) {
        reachable_[static_cast<std::size_t>(index)] = true;
        for (const int child : below) playback_.motion.nodes[static_cast<std::size_t>(child)].parent = index;
    }
    for (const auto& [index, unused] : children) read_transform(index);
    read_animations(model, reachable_, builder, playback_.motion);
    for (const auto& [index, unused] : children) read_skin_of(index);
    pose_ = playback_.motion.pose(builder.options().at);
}

void GltfMotion::read_transform(int index) {
    const tinygltf::Node& source = model_.nodes[static_cast<std::size_t>(index)];
    MovingNode& node = playback_.motion.nodes[static_cast<std::size_t>(index)];
    node.name = source.name.empty() ? "node " + std::to_string(index) : source.name;
    node.weights = source.weights;
    if (source.weights.empty() && source.mesh >= 0 &&
        static_cast<std::size_t>(source.mesh) < model_.meshes.size())
        node.weights = model_.meshes[static_cast<std::size_t>(source.mesh)].weights;
    const auto matrix = node_matrix(source);
    if (!matrix) {
        builder_.notice("node '" + node.name + "': " + matrix.error().what() + "; its transform is ignored");
        return;
    }
    node.rest = *matrix;
    const auto& t = source.translation;
    const auto& r = source.rotation;
    const auto& s = source.scale;
    if (!t.empty()) node.translation = {t[0], t[1], t[2]};
    if (!r.empty()) node.rotation = {r[0], r[1], r[2], r[3]};
    if (!s.empty()) node.scale = {s[0], s[1], s[2]};
}

void GltfMotion::read_skin_of(int index) {
    const tinygltf::Node& source = model_.nodes[static_cast<std::size_t>(index)];
    if (source.skin == -1 || source.mesh < 0 || static_cast<std::size_t>(source.mesh) >= model_.meshes.size())
        return;
    const auto [entry, is_new] = skins_.try_emplace(source.skin, -1);
    if (is_new) {
        try {
            playback_.skins.push_back(read_skin(model_, source.skin, playback_.motion.nodes, reachable_));
            entry->second = static_cast<int>(playback_.skins.size() - 1);
        } catch (const Error& error) {
            if (error.code() != ErrorCode::InvalidInput) throw;
            builder_.notice("skin " + std::to_string(source.skin) + " is ignored: " + error.what() +
                            "; its meshes are drawn without skinning");
        }
    }
    if (entry->second < 0) return;
    if (!has_joints(model_.meshes[static_cast<std::size_t>(source.mesh)])) {
        builder_.notice("node '" + node(index).name + "': its skin is ignored, the mesh has no joints");
        return;
    }
    skin_of_node_[index] = entry->second;
}

std::optional<int> GltfMotion::skeleton_root(int index) const {
    const auto skin = skin_of_node_.find(index);
    if (skin == skin_of_node_.end()) return std::nullopt;
    return playback_.skins[static_cast<std::size_t>(skin->second)].skeleton_root;
}

std::uint32_t GltfMotion::layers(int index) const {
    for (; index >= 0; index = node(index).parent) {
        if (const std::uint32_t own = layers_[static_cast<std::size_t>(index)]; own != 0) return own;
    }
    return scene::RootLayers;
}

bool GltfMotion::deforms(int index) const {
    return skin_of_node_.contains(index) || node(index).weights_track >= 0 ||
           !model_.nodes[static_cast<std::size_t>(index)].weights.empty();
}

std::vector<ObjectId> GltfMotion::deformed_geometries(int index, GltfMeshes& meshes) {
    const auto skin = skin_of_node_.find(index);
    const int number = skin == skin_of_node_.end() ? -1 : skin->second;
    std::vector<glm::dmat4> joints;
    if (number >= 0) {
        joints =
            joint_matrices(playback_.skins[static_cast<std::size_t>(number)], playback_.motion.nodes, pose_);
    }
    std::vector<DeformedGeometry> deformed;
    std::vector<ObjectId> geometries =
        meshes.deformed_geometries(model_.nodes[static_cast<std::size_t>(index)].mesh,
                                   {pose_.weights[static_cast<std::size_t>(index)], joints}, deformed);
    if (!keeps_playback()) return geometries;
    for (DeformedGeometry& geometry : deformed) {
        geometry.node = index;
        geometry.skin = number;
        playback_.deformed.push_back(std::move(geometry));
    }
    return geometries;
}

bool GltfMotion::is_animated(int index, int end) const {
    for (; index != end; index = node(index).parent) {
        if (node(index).moves()) return true;
    }
    return false;
}

bool GltfMotion::keeps_playback() const {
    return builder_.options().motion == Motion::Sequence || builder_.options().shutter > 0.0;
}

void GltfMotion::keep_playback() {
    if (!keeps_playback() || playback_.motion.tracks.empty()) return;
    const bool is_sequence = builder_.options().motion == Motion::Sequence;
    for (std::size_t i = 0; i < playback_.transforms.size() && is_sequence; ++i) {
        if (const ObjectId id = playback_.transforms[i]; id && playback_.motion.nodes[i].moves())
            builder_.get<scene::Transform>(id).hint = scene::MotionHint::Animated;
    }
    std::erase_if(playback_.deformed, [&](const DeformedGeometry& geometry) {
        if (node(geometry.node).weights_track >= 0) return false;
        if (geometry.skin < 0) return true;
        const Skin& skin = playback_.skins[static_cast<std::size_t>(geometry.skin)];
        return std::none_of(skin.joints.begin(), skin.joints.end(),
                            [&](int joint) { return is_animated(joint, skin.skeleton_root); });
    });
    for (const DeformedGeometry& geometry : playback_.deformed) {
        if (!is_sequence) break;
        builder_.get<scene::Geometry>(geometry.geometry).hint = scene::MotionHint::Animated;
    }
    builder_.result().seconds = builder_.options().at;
    builder_.result().playback = std::make_shared<const Playback>(std::move(playback_));
}

}  // namespace tessera::import

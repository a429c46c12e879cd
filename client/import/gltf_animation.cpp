#include "client/import/gltf_animation.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "client/import/gltf_accessor.h"
#include "client/import/gltf_deformation.h"
#include "client/import/reject.h"

namespace tessera::import {
namespace {

std::string name_of(const tinygltf::Model& model, std::size_t animation) {
    const std::string& name = model.animations[animation].name;
    return name.empty() ? "animation " + std::to_string(animation) : name;
}

Interpolation interpolation(const std::string& name) {
    if (name == "LINEAR" || name.empty()) return Interpolation::Linear;
    if (name == "STEP") return Interpolation::Step;
    if (name == "CUBICSPLINE") return Interpolation::CubicSpline;
    reject("its interpolation is none of LINEAR, STEP and CUBICSPLINE");
}

template <class Vector>
std::vector<float> numbers(const std::vector<Vector>& vectors) {
    std::vector<float> values;
    values.reserve(vectors.size() * Vector::length());
    for (const Vector& vector : vectors) {
        for (int i = 0; i < Vector::length(); ++i) values.push_back(vector[i]);
    }
    return values;
}

enum class Property { Translation, Rotation, Scale, Weights };

Property property(const std::string& path) {
    if (path == "translation") return Property::Translation;
    if (path == "rotation") return Property::Rotation;
    if (path == "scale") return Property::Scale;
    if (path == "weights") return Property::Weights;
    reject("its target is none of translation, rotation, scale and weights");
}

int& track_of(MovingNode& node, Property property) {
    switch (property) {
        case Property::Translation:
            return node.translation_track;
        case Property::Rotation:
            return node.rotation_track;
        case Property::Scale:
            return node.scale_track;
        case Property::Weights:
            break;
    }
    return node.weights_track;
}

class Reader {
  public:
    Reader(const tinygltf::Model& model, const std::vector<bool>& reached, SceneBuilder& builder,
           NodeMotion& motion)
        : model_(model), accessors_(model), reached_(reached), builder_(builder), motion_(motion) {}

    void read(std::size_t animation) {
        const auto& channels = model_.animations[animation].channels;
        for (std::size_t i = 0; i < channels.size(); ++i) {
            try {
                read_channel(animation, channels[i]);
            } catch (const Error& error) {
                if (error.code() != ErrorCode::InvalidInput) throw;
                builder_.notice("animation '" + name_of(model_, animation) + "': channel " +
                                std::to_string(i) + " is left out: " + error.what());
            }
        }
    }

  private:
    void read_channel(std::size_t animation, const tinygltf::AnimationChannel& channel) {
        const int target = channel.target_node;
        if (target < 0 || static_cast<std::size_t>(target) >= reached_.size()) reject("its node is missing");
        if (!reached_[static_cast<std::size_t>(target)]) return;  // belongs to another scene of the file
        const tinygltf::Node& source = model_.nodes[static_cast<std::size_t>(target)];
        const Property moved = property(channel.target_path);
        if (moved != Property::Weights && !source.matrix.empty())
            reject("its node has a matrix instead of translation, rotation and scale");
        int& track = track_of(motion_.nodes[static_cast<std::size_t>(target)], moved);
        const auto [owner, is_first] = owners_.try_emplace({target, moved}, animation);
        if (!is_first) {
            if (owner->second == animation) reject("an earlier channel animates the same property");
            builder_.notice("animation '" + name_of(model_, animation) +
                            "' animates properties that an earlier animation also animates; the earlier one "
                            "is played: choose one of them");
            return;
        }
        track = read_track(animation, channel.sampler, moved, source);
    }

    // Number of morph targets of the node's mesh.
    std::size_t weight_count(const tinygltf::Node& node) const {
        if (node.mesh < 0 || static_cast<std::size_t>(node.mesh) >= model_.meshes.size())
            reject("its node has no mesh");
        const std::size_t count = target_count(model_.meshes[static_cast<std::size_t>(node.mesh)]);
        if (count == 0) reject("its mesh has no morph targets");
        return count;
    }

    int read_track(std::size_t animation, int sampler, Property moved, const tinygltf::Node& node) {
        const std::size_t width = moved == Property::Rotation  ? 4
                                  : moved == Property::Weights ? weight_count(node)
                                                               : 3;
        const bool is_vector = moved == Property::Translation || moved == Property::Scale;
        const std::tuple key(animation, sampler, is_vector ? Property::Scale : moved, width);
        if (const auto entry = known_.find(key); entry != known_.end()) return entry->second;

        const auto& samplers = model_.animations[animation].samplers;
        if (sampler < 0 || static_cast<std::size_t>(sampler) >= samplers.size())
            reject("its sampler is missing");
        const tinygltf::AnimationSampler& source = samplers[static_cast<std::size_t>(sampler)];
        KeyTrack track{.interpolation = interpolation(source.interpolation), .width = width};
        builder_.spend((accessors_.count(source.input) + accessors_.count(source.output) * 4) *
                       sizeof(float));
        track.times = accessors_.scalars(source.input);
        if (is_vector) {
            track.values = numbers(accessors_.vec3(source.output));
        } else if (moved == Property::Rotation) {
            track.values = numbers(accessors_.vec4(source.output));
        } else {
            track.values = accessors_.scalars(source.output);
        }
        if (moved == Property::Rotation) {
            check_rotation(track);
        } else {
            check(track);
        }
        motion_.tracks.push_back(std::move(track));
        return known_[key] = static_cast<int>(motion_.tracks.size() - 1);
    }

    const tinygltf::Model& model_;
    GltfAccessors accessors_;
    const std::vector<bool>& reached_;
    SceneBuilder& builder_;
    NodeMotion& motion_;
    std::map<std::tuple<std::size_t, int, Property, std::size_t>, int> known_;
    std::map<std::pair<int, Property>, std::size_t> owners_;
};

// 0 for invalid keys: their channels are skipped with a notice.
double last_time(const GltfAccessors& accessors, int input, SceneBuilder& builder) {
    double last = 0.0;
    try {
        builder.spend(accessors.count(input) * sizeof(float));
        for (const float time : accessors.scalars(input)) {
            if (std::isfinite(time)) last = std::max(last, double(time));
        }
    } catch (const Error& error) {
        if (error.code() != ErrorCode::InvalidInput) throw;
    }
    return last;
}

// By name, else by index.
std::size_t chosen(const tinygltf::Model& model, const std::string& choice) {
    constexpr std::size_t MostListed = 24;
    std::string list;
    for (std::size_t i = 0; i < model.animations.size(); ++i) {
        if (name_of(model, i) == choice) return i;
        if (i < MostListed) list += (i == 0 ? "" : ", ") + std::to_string(i) + " '" + name_of(model, i) + "'";
    }
    const bool is_number =
        !choice.empty() && choice.size() < 9 && choice.find_first_not_of("0123456789") == std::string::npos;
    if (is_number && std::stoul(choice) < model.animations.size()) return std::stoul(choice);
    reject("there is no animation '" + choice + "'" + (list.empty() ? "" : "; it has: " + list));
}

}  // namespace

std::vector<AnimationInfo> list_animations(const tinygltf::Model& model, SceneBuilder& builder) {
    const GltfAccessors accessors(model);
    std::map<int, double> last_key;  // of accessors
    std::vector<AnimationInfo> animations;
    for (std::size_t i = 0; i < model.animations.size(); ++i) {
        AnimationInfo info{.name = name_of(model, i)};
        for (const tinygltf::AnimationSampler& sampler : model.animations[i].samplers) {
            const auto [last, is_new] = last_key.try_emplace(sampler.input, 0.0);
            if (is_new) last->second = last_time(accessors, sampler.input, builder);
            info.seconds = std::max(info.seconds, last->second);
        }
        animations.push_back(std::move(info));
    }
    return animations;
}

void read_animations(const tinygltf::Model& model, const std::vector<bool>& reached, SceneBuilder& builder,
                     NodeMotion& motion) {
    Reader reader(model, reached, builder, motion);
    if (const std::string& choice = builder.options().animation; !choice.empty())
        return reader.read(chosen(model, choice));
    for (std::size_t i = 0; i < model.animations.size(); ++i) reader.read(i);
}

}  // namespace tessera::import

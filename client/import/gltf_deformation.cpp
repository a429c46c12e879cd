#include "client/import/gltf_deformation.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "client/import/reject.h"

namespace tessera::import {
namespace {

std::string numbered(const char* name, std::size_t number) {
    return name + std::to_string(number);
}

std::vector<glm::vec3> differences(const std::map<std::string, int>& target, const char* name,
                                   std::size_t vertices, const GltfAccessors& accessors,
                                   SceneBuilder& builder) {
    const auto found = target.find(name);
    if (found == target.end()) return {};
    if (const std::uint64_t count = accessors.count(found->second); count != vertices) {
        reject("a morph target has " + std::to_string(count) + " offsets for " + std::to_string(vertices) +
               " vertices");
    }
    builder.spend(vertices * sizeof(glm::vec3));
    std::vector<glm::vec3> values = accessors.vec3(found->second);
    for (const glm::vec3& value : values) {
        if (!std::isfinite(value.x + value.y + value.z)) reject("a morph target is not finite");
    }
    return values;
}

JointSet read_set(const tinygltf::Primitive& primitive, std::size_t number, std::size_t vertices,
                  const GltfAccessors& accessors, SceneBuilder& builder) {
    const auto weights = primitive.attributes.find(numbered("WEIGHTS_", number));
    if (weights == primitive.attributes.end()) reject(numbered("it lacks WEIGHTS_", number));
    const int joints = primitive.attributes.at(numbered("JOINTS_", number));
    if (accessors.count(joints) != vertices || accessors.count(weights->second) != vertices)
        reject("its joints or weights are not one per vertex");
    builder.spend(vertices * (sizeof(glm::u16vec4) + sizeof(glm::vec4)));
    return {accessors.joints(joints), accessors.vec4(weights->second)};
}

}  // namespace

DeformableMesh read_deformation(const tinygltf::Primitive& primitive, std::size_t vertices, Joints joints,
                                std::vector<JointSet> decoded, const GltfAccessors& accessors,
                                SceneBuilder& builder) {
    DeformableMesh mesh;
    for (const auto& target : primitive.targets) {
        mesh.targets.push_back({differences(target, "POSITION", vertices, accessors, builder),
                                differences(target, "NORMAL", vertices, accessors, builder),
                                differences(target, "TANGENT", vertices, accessors, builder)});
    }
    if (joints == Joints::Ignored) return mesh;
    mesh.sets = std::move(decoded);
    for (std::size_t i = mesh.sets.size(); primitive.attributes.contains(numbered("JOINTS_", i)); ++i)
        mesh.sets.push_back(read_set(primitive, i, vertices, accessors, builder));
    normalize_weights(mesh.sets);
    for (const JointSet& set : mesh.sets) {
        for (const glm::u16vec4& four : set.joints) {
            for (int k = 0; k < 4; ++k)
                mesh.joint_count = std::max<std::size_t>(mesh.joint_count, four[k] + std::size_t{1});
        }
    }
    return mesh;
}

std::size_t target_count(const tinygltf::Mesh& mesh) {
    return mesh.primitives.empty() ? 0 : mesh.primitives.front().targets.size();
}

bool has_joints(const tinygltf::Mesh& mesh) {
    return std::all_of(mesh.primitives.begin(), mesh.primitives.end(),
                       [](const auto& primitive) { return primitive.attributes.contains("JOINTS_0"); });
}

Skin read_skin(const tinygltf::Model& model, int index, const std::vector<MovingNode>& nodes,
               const std::vector<bool>& reached) {
    if (index < 0 || static_cast<std::size_t>(index) >= model.skins.size()) reject("it is missing");
    const tinygltf::Skin& source = model.skins[static_cast<std::size_t>(index)];
    if (source.joints.empty()) reject("it has no joints");
    for (const int joint : source.joints) {
        if (joint < 0 || static_cast<std::size_t>(joint) >= reached.size() ||
            !reached[static_cast<std::size_t>(joint)]) {
            reject("its joint " + std::to_string(joint) + " is not in the scene");
        }
    }
    Skin skin{.joints = source.joints};
    if (source.inverseBindMatrices == -1) {
        skin.inverse_binds.assign(skin.joints.size(), glm::dmat4(1.0));
    } else {
        skin.inverse_binds = GltfAccessors(model).matrices(source.inverseBindMatrices);
    }
    if (skin.inverse_binds.size() < skin.joints.size()) {
        reject("it has " + std::to_string(skin.inverse_binds.size()) + " matrices for " +
               std::to_string(skin.joints.size()) + " joints");
    }
    for (const glm::dmat4& matrix : skin.inverse_binds) {
        for (int column = 0; column < 4; ++column) {
            const glm::dvec4& c = matrix[column];
            if (!std::isfinite(c.x + c.y + c.z + c.w)) reject("one of its matrices is not finite");
        }
    }
    skin.skeleton_root = skeleton_root_of(skin.joints, nodes);
    return skin;
}

}  // namespace tessera::import

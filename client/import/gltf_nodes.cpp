#include "client/import/gltf_nodes.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>

#include "client/import/gltf_document.h"
#include "client/import/gltf_extras.h"
#include "client/import/gltf_placement.h"
#include "client/import/limits.h"

namespace tessera::import {
namespace {

constexpr const char* Instancing = "EXT_mesh_gpu_instancing";
constexpr const char* LightsExtension = "KHR_lights_punctual";

std::string display_name(const tinygltf::Model& model, int node) {
    const std::string& name = model.nodes[static_cast<std::size_t>(node)].name;
    return name.empty() ? "node " + std::to_string(node) : name;
}

// Programs that export custom properties write booleans as numbers, too.
bool casts_no_hard_shadow(const tinygltf::Light& light, SceneBuilder& builder) {
    if (!light.extras.IsObject() || !light.extras.Has("hard_shadow")) return false;
    const tinygltf::Value& value = light.extras.Get("hard_shadow");
    if (value.IsBool()) return !value.Get<bool>();
    if (value.IsNumber()) return value.GetNumberAsDouble() == 0.0;
    builder.notice("light '" + light.name +
                   "': its extra hard_shadow is neither a boolean nor a number: it is ignored");
    return false;
}

bool has_only_a_mesh(const tinygltf::Node& node) {
    return node.camera == -1 && !node.extensions.contains(LightsExtension);
}

template <class T>
void append(std::vector<T>& to, const std::vector<T>& values) {
    to.insert(to.end(), values.begin(), values.end());
}

}  // namespace

std::vector<int> GltfNodes::scene_roots() {
    if (!model_.scenes.empty()) {
        int chosen = std::max(model_.defaultScene, 0);
        if (static_cast<std::size_t>(chosen) >= model_.scenes.size()) {
            builder_.notice("scene " + std::to_string(chosen) + " is missing: scene 0 is drawn");
            chosen = 0;
        }
        if (model_.scenes.size() > 1) {
            builder_.notice("of " + std::to_string(model_.scenes.size()) + " scenes only scene " +
                            std::to_string(chosen) + " is drawn");
        }
        return model_.scenes[static_cast<std::size_t>(chosen)].nodes;
    }
    std::vector<bool> is_child(model_.nodes.size(), false);
    for (const tinygltf::Node& node : model_.nodes) {
        for (const int child : node.children) {
            if (child >= 0 && static_cast<std::size_t>(child) < is_child.size()) {
                is_child[static_cast<std::size_t>(child)] = true;
            }
        }
    }
    std::vector<int> roots;
    for (std::size_t i = 0; i < is_child.size(); ++i) {
        if (!is_child[i]) roots.push_back(static_cast<int>(i));
    }
    return roots;
}

GltfNodes::Tree GltfNodes::traverse() {
    struct Visit {
        int node;
        std::size_t depth;
    };
    Tree tree;
    std::vector<Visit> stack;
    const auto enter = [&](int node, std::size_t depth, std::vector<int>& siblings) {
        const std::string number = std::to_string(node);
        if (node < 0 || static_cast<std::size_t>(node) >= model_.nodes.size()) {
            builder_.notice("node " + number + " is missing: the reference to it is ignored");
        } else if (depth > MaxNesting) {
            builder_.notice("nodes nested more than " + std::to_string(MaxNesting) + " deep are not drawn");
        } else if (!tree.children.try_emplace(node).second) {
            builder_.notice("node " + number +
                            " has several parents or is its own ancestor: it is drawn once");
        } else {
            siblings.push_back(node);
            stack.push_back({node, depth});
        }
    };
    for (const int root : scene_roots()) enter(root, 1, tree.roots);
    while (!stack.empty()) {
        const Visit visit = stack.back();
        stack.pop_back();
        for (const int child : model_.nodes[static_cast<std::size_t>(visit.node)].children) {
            enter(child, visit.depth + 1, tree.children[visit.node]);
        }
    }
    return tree;
}

std::vector<ObjectId> GltfNodes::build() {
    const Tree tree = traverse();
    GltfMotion motion(model_, builder_, tree.children);
    for (const auto& [node, unused] : tree.children) motion.set_layers(node, layers_of(node));
    std::map<int, ObjectId> ids;
    std::map<int, std::vector<ObjectId>> skinned;  // transforms of skinned meshes, by skeleton root
    for (const auto& [index, below] : tree.children) {
        const std::optional<int> skeleton_root = motion.skeleton_root(index);
        if (skeleton_root && below.empty() &&
            has_only_a_mesh(model_.nodes[static_cast<std::size_t>(index)])) {
            // The skin ignores the node's transform, and the node has nothing else.
            ids[index] = add_skinned_transform(index, display_name(model_, index), motion);
            skinned[*skeleton_root].push_back(ids[index]);
        } else {
            ids[index] = add_transform(index, motion);
        }
    }
    for (const auto& [index, below] : tree.children) {
        const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(index)];
        const std::string name = display_name(model_, index);
        std::vector<ObjectId> children;
        for (const int child : below) {
            if (motion.has_transform(child)) children.push_back(ids.at(child));
        }
        if (node.mesh != -1) {
            const auto geometries = motion.deforms(index) ? motion.deformed_geometries(index, meshes_)
                                                          : meshes_.geometries(node.mesh);
            const std::optional<int> skeleton_root = motion.skeleton_root(index);
            if (!skeleton_root) {
                add_mesh(node, name, geometries, children);
            } else {
                count_instances(geometries.size());
                ObjectId transform = ids.at(index);
                if (motion.has_transform(index)) {
                    transform = add_skinned_transform(index, name + " posed", motion);
                    skinned[*skeleton_root].push_back(transform);
                }
                builder_.get<scene::Transform>(transform).children = geometries;
            }
        }
        add_light(node, name, children);
        if (node.camera != -1) add_camera(node, name, children);
        if (motion.has_transform(index)) builder_.get<scene::Transform>(ids.at(index)).children = children;
    }
    std::vector<ObjectId> roots;
    for (const int root : tree.roots) {
        if (motion.has_transform(root)) roots.push_back(ids.at(root));
    }
    for (const auto& [skeleton_root, transforms] : skinned) {
        append(skeleton_root < 0 ? roots : builder_.get<scene::Transform>(ids.at(skeleton_root)).children,
               transforms);
    }
    motion.keep_playback();
    return roots;
}

ObjectId GltfNodes::add_transform(int index, GltfMotion& motion) {
    scene::Transform transform;
    transform.name = display_name(model_, index);
    transform.matrix = motion.local(index);
    transform.layers = motion.own_layers(index);
    const ObjectId id = builder_.add(std::move(transform));
    motion.set_transform(index, id);
    return id;
}

ObjectId GltfNodes::add_skinned_transform(int index, const std::string& name, const GltfMotion& motion) {
    scene::Transform transform;
    transform.name = name;
    if (motion.layers(index) != motion.layers(*motion.skeleton_root(index)))
        transform.layers = motion.layers(index);
    return builder_.add(std::move(transform));
}

std::uint32_t GltfNodes::layers_of(int node) {
    const auto layers = node_layers(model_.nodes[static_cast<std::size_t>(node)]);
    if (layers) return *layers;
    builder_.notice("node '" + display_name(model_, node) + "': " + layers.error().what() +
                    "; it is in its parent's layers");
    return 0;
}

void GltfNodes::add_mesh(const tinygltf::Node& node, const std::string& name,
                         const std::vector<ObjectId>& geometries, std::vector<ObjectId>& children) {
    std::vector<glm::dmat4> matrices;
    if (node.extensions.contains(Instancing)) {
        try {
            matrices = instance_matrices(node);
        } catch (const Error& error) {
            builder_.notice("node '" + name + "': its instances are invalid (" + error.what() +
                            "); one is drawn");
        }
    }
    count_instances(geometries.size() * std::max<std::uint64_t>(matrices.size(), 1));
    if (matrices.empty()) {
        append(children, geometries);
        return;
    }
    for (std::size_t i = 0; i < matrices.size(); ++i) {
        scene::Transform instance;
        instance.name = name + " instance " + std::to_string(i);
        instance.matrix = matrices[i];
        instance.children = geometries;
        children.push_back(builder_.add(std::move(instance)));
    }
}

void GltfNodes::count_instances(std::uint64_t more) {
    instances_ += more;
    if (instances_ > MaxInstances) {
        throw Error(ErrorCode::InvalidInput,
                    "it has more than " + std::to_string(MaxInstances) + " mesh instances: split the scene");
    }
}

std::vector<glm::dmat4> GltfNodes::instance_matrices(const tinygltf::Node& node) {
    const tinygltf::Value& extension = node.extensions.at(Instancing);
    const tinygltf::Value none;
    const tinygltf::Value& attributes = extension.Has("attributes") ? extension.Get("attributes") : none;
    const int translation = index_member(attributes, "TRANSLATION");
    const int rotation = index_member(attributes, "ROTATION");
    const int scale = index_member(attributes, "SCALE");
    std::vector<glm::vec3> translations, scales;
    std::vector<glm::vec4> rotations;
    if (translation >= 0) translations = accessors_.vec3(translation);
    if (rotation >= 0) rotations = accessors_.vec4(rotation);
    if (scale >= 0) scales = accessors_.vec3(scale);
    const std::size_t count = std::max({translations.size(), rotations.size(), scales.size()});
    for (const std::size_t size : {translations.size(), rotations.size(), scales.size()}) {
        if (size != 0 && size != count) throw Error(ErrorCode::InvalidInput, "its arrays differ in length");
    }
    if (count > MaxInstances) throw Error(ErrorCode::InvalidInput, "there are too many");
    std::vector<glm::dmat4> matrices;
    for (std::size_t i = 0; i < count; ++i) {
        const auto matrix =
            placement(translations.empty() ? glm::dvec3(0.0) : glm::dvec3(translations[i]),
                      rotations.empty() ? glm::dvec4(0.0, 0.0, 0.0, 1.0) : glm::dvec4(rotations[i]),
                      scales.empty() ? glm::dvec3(1.0) : glm::dvec3(scales[i]));
        if (!matrix) throw matrix.error();
        matrices.push_back(*matrix);
    }
    return matrices;
}

void GltfNodes::adapt(scene::Light& light, const tinygltf::Light& source) {
    if (builder_.options().light_units == LightUnits::Blender) {
        light.intensity /= LumensPerWatt;
        if (!has_divided_lights_)
            builder_.notice("the intensities of its lights are divided by 683 lm/W: units of Blender");
        has_divided_lights_ = true;
    }
    if (std::isfinite(source.range) && source.range > 0.0) {
        builder_.notice("light '" + light.name +
                        "': its range is not used, light falls off with the square of the distance");
    }
}

void GltfNodes::add_light(const tinygltf::Node& node, const std::string& name,
                          std::vector<ObjectId>& children) {
    const auto extension = node.extensions.find(LightsExtension);
    if (extension == node.extensions.end()) return;
    const int index = index_member(extension->second, "light");
    if (index < 0 || static_cast<std::size_t>(index) >= model_.lights.size()) {
        builder_.notice("node '" + name + "': its light " + std::to_string(index) + " is missing");
        return;
    }
    ObjectId& id = lights_[index];
    if (!id) {
        auto light = punctual_light(model_.lights[static_cast<std::size_t>(index)]);
        if (!light) {
            builder_.notice("node '" + name + "': its light is left out, " + light.error().what());
            return;
        }
        if (light->name.empty()) light->name = name;
        adapt(*light, model_.lights[static_cast<std::size_t>(index)]);
        if (const auto* own =
                object_extras(model_.lights[static_cast<std::size_t>(index)].extras, LightExtras))
            read_extras(*own, *light, "light '" + light->name + "'", builder_);
        id = builder_.add(std::move(*light));
        if (casts_no_hard_shadow(model_.lights[static_cast<std::size_t>(index)], builder_))
            builder_.mark_soft(id);
    }
    children.push_back(id);
}

void GltfNodes::add_camera(const tinygltf::Node& node, const std::string& name,
                           std::vector<ObjectId>& children) {
    if (node.camera < 0 || static_cast<std::size_t>(node.camera) >= model_.cameras.size()) {
        builder_.notice("node '" + name + "': its camera " + std::to_string(node.camera) + " is missing");
        return;
    }
    auto camera = camera_of(model_.cameras[static_cast<std::size_t>(node.camera)]);
    if (!camera) {
        builder_.notice("node '" + name + "': its camera is left out, " + camera.error().what());
        return;
    }
    if (!node.name.empty() || camera->name.empty()) camera->name = name;
    if (const auto* own =
            object_extras(model_.cameras[static_cast<std::size_t>(node.camera)].extras, CameraExtras))
        read_extras(*own, *camera, "camera '" + camera->name + "'", builder_);
    children.push_back(builder_.add(std::move(*camera)));
}

}  // namespace tessera::import

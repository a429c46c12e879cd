#include "client/export/glb_nodes.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <numbers>

#include "client/export/glb_extras.h"
#include "client/export/glb_text.h"
#include "client/import/gltf_extras.h"
#include "client/import/gltf_placement.h"

namespace tessera::exporting {
namespace {

constexpr std::uint64_t MaxNodes = 1'000'000;

// The nearest type for lights that glTF lacks: a sphere emits in all directions, a quad to one side.
const char* type_name(scene::LightKind kind) {
    switch (kind) {
        case scene::LightKind::Point:
        case scene::LightKind::Sphere:
            return "point";
        case scene::LightKind::Spot:
        case scene::LightKind::Quad:
            return "spot";
        case scene::LightKind::Directional:
            return "directional";
    }
    return "point";
}

void set_light(tinygltf::Node& node, int light) {
    using tinygltf::Value;
    node.extensions["KHR_lights_punctual"] = Value(Value::Object{{"light", Value(light)}});
}

void set_layers(tinygltf::Node& node, std::uint32_t layers) {
    using tinygltf::Value;
    node.extras = Value(Value::Object{{"tessera_layers", Value(static_cast<double>(layers))}});
}

void set_extras(tinygltf::Value& extras, const char* name, tinygltf::Value value) {
    using tinygltf::Value;
    if (!value.IsObject() || value.Size() > 0) extras = Value(Value::Object{{name, std::move(value)}});
}

// Checked first, as shared transforms may expand to any number of nodes.
void check_size(const scene::Scene& scene, const std::vector<ObjectId>& roots) {
    std::vector<ObjectId> open = roots;
    for (std::uint64_t count = 0; !open.empty(); ++count) {
        if (count > MaxNodes) {
            throw Error(ErrorCode::InvalidInput, "the scene expands to more than " +
                                                     std::to_string(MaxNodes) +
                                                     " nodes: save it as .tessera, or split it");
        }
        const auto* transform = scene.find_as<scene::Transform>(open.back());
        open.pop_back();
        if (transform) open.insert(open.end(), transform->children.begin(), transform->children.end());
    }
}

}  // namespace

int GlbNodes::add_node(const std::string& name) {
    tinygltf::Node node;
    node.name = utf8(name);
    model_.nodes.push_back(std::move(node));
    return static_cast<int>(model_.nodes.size()) - 1;
}

std::vector<int> GlbNodes::build(const std::vector<ObjectId>& roots) {
    check_size(scene_, roots);
    std::vector<int> result = attach(roots, -1);
    while (!pending_.empty()) {
        const PendingNode current = pending_.back();
        pending_.pop_back();
        const auto& transform = *scene_.find_as<scene::Transform>(current.transform);
        std::vector<int> below = attach(transform.children, current.node);
        auto& node = model_.nodes[static_cast<std::size_t>(current.node)];
        node.children = std::move(below);
        if (transform.layers != 0) set_layers(node, transform.layers);
        if (transform.matrix == glm::dmat4(1.0)) continue;
        for (int i = 0; i < 16; ++i) node.matrix.push_back(transform.matrix[i / 4][i % 4]);
    }
    return result;
}

std::vector<int> GlbNodes::attach(const std::vector<ObjectId>& objects, int node) {
    std::vector<int> below;
    std::vector<ObjectId> geometries;
    // The node itself takes the first of each kind, if there is a node.
    const auto node_for = [&](const std::string& name, auto is_free) {
        if (node >= 0 && is_free(model_.nodes[static_cast<std::size_t>(node)])) return node;
        below.push_back(add_node(name));
        return below.back();
    };
    for (const ObjectId id : objects) {
        const scene::Object& object = *scene_.find(id);
        const std::string& name = scene::name(object);
        if (std::holds_alternative<scene::Transform>(object)) {
            below.push_back(add_node(name));
            pending_.push_back({id, below.back()});
        } else if (std::holds_alternative<scene::Geometry>(object)) {
            geometries.push_back(id);
        } else if (std::holds_alternative<scene::Light>(object)) {
            const int target =
                node_for(name, [](const tinygltf::Node& one) { return one.extensions.empty(); });
            set_light(model_.nodes[static_cast<std::size_t>(target)], light(id));
        } else if (std::holds_alternative<scene::Camera>(object)) {
            const int target = node_for(name, [](const tinygltf::Node& one) { return one.camera < 0; });
            model_.nodes[static_cast<std::size_t>(target)].camera = camera(id);
        }
    }
    if (!geometries.empty()) attach_geometries(geometries, node, below);
    return below;
}

void GlbNodes::attach_geometries(const std::vector<ObjectId>& geometries, int node, std::vector<int>& below) {
    // Geometries named by the importer as parts of one mesh become one mesh again.
    const std::string& first = scene::name(*scene_.find(geometries[0]));
    bool is_one_mesh = node >= 0;
    for (std::size_t i = 1; i < geometries.size(); ++i) {
        is_one_mesh &= scene::name(*scene_.find(geometries[i])) == first + " part " + std::to_string(i);
    }
    if (is_one_mesh) {
        model_.nodes[static_cast<std::size_t>(node)].mesh = mesh(geometries);
        return;
    }
    for (const ObjectId id : geometries) {
        below.push_back(add_node(scene::name(*scene_.find(id))));
        model_.nodes[static_cast<std::size_t>(below.back())].mesh = mesh({id});
    }
}

int GlbNodes::mesh(const std::vector<ObjectId>& geometries) {
    const auto [entry, is_new] = meshes_.try_emplace(geometries, 0);
    if (!is_new) return entry->second;
    tinygltf::Mesh mesh;
    mesh.name = utf8(scene::name(*scene_.find(geometries[0])));
    using enum GlbBuffer::Role;
    for (const ObjectId id : geometries) {
        const auto& geometry = *scene_.find_as<scene::Geometry>(id);
        tinygltf::Primitive primitive;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
        const int medium = materials_.medium(geometry.medium);
        if (medium >= 0) set_extras(primitive.extras, import::MediumExtras, tinygltf::Value(medium));
        // A medium boundary without a surface has no material; other programs use glTF's default.
        if (geometry.material || medium < 0) primitive.material = materials_.material(geometry.material);
        primitive.indices = buffer_.accessor(geometry.indices, Indices, 1);
        const auto add = [&](const char* name, const scene::BlobRef& array, GlbBuffer::Role role,
                             int components) {
            if (!array.empty()) primitive.attributes[name] = buffer_.accessor(array, role, components);
        };
        add("POSITION", geometry.positions, Positions, 3);
        add("NORMAL", geometry.normals, Other, 3);
        if (!geometry.normals.empty()) add("TANGENT", geometry.tangents, Other, 4);
        add("TEXCOORD_0", geometry.tex_coords, Other, 2);
        add("TEXCOORD_1", geometry.tex_coords_1, Other, 2);
        add("COLOR_0", geometry.colors, Other, 4);
        mesh.primitives.push_back(std::move(primitive));
    }
    model_.meshes.push_back(std::move(mesh));
    return entry->second = static_cast<int>(model_.meshes.size()) - 1;
}

int GlbNodes::light(ObjectId id) {
    const auto [entry, is_new] = lights_.try_emplace(id, 0);
    if (!is_new) return entry->second;
    const auto& light = *scene_.find_as<scene::Light>(id);
    tinygltf::Light result;
    result.name = utf8(light.name);
    result.type = type_name(light.kind);
    const double brightest = std::max({light.intensity.r, light.intensity.g, light.intensity.b});
    result.intensity = brightest;
    for (int i = 0; i < 3; ++i)
        result.color.push_back(brightest > 0.0 ? light.intensity[i] / brightest : 1.0);
    const bool is_quad = light.kind == scene::LightKind::Quad;
    result.spot.innerConeAngle = is_quad ? 0.0 : double{light.inner_cone_angle};
    result.spot.outerConeAngle = is_quad ? std::numbers::pi / 2 : double{light.outer_cone_angle};
    // The fields that glTF's own properties do not restore.
    if (auto plain = import::punctual_light(result)) {
        plain->name = light.name;
        plain->intensity = light.intensity;
        set_extras(result.extras, import::LightExtras, extras_of(light, changed_fields(light, *plain)));
    }
    model_.lights.push_back(std::move(result));
    return entry->second = static_cast<int>(model_.lights.size()) - 1;
}

int GlbNodes::camera(ObjectId id) {
    const auto [entry, is_new] = cameras_.try_emplace(id, 0);
    if (!is_new) return entry->second;
    const auto& camera = *scene_.find_as<scene::Camera>(id);
    tinygltf::Camera result;
    result.name = utf8(camera.name);
    // glTF requires clipping planes; our cameras have none.
    if (camera.projection == scene::Projection::Orthographic) {
        result.type = "orthographic";
        result.orthographic.ymag = 0.5 * camera.orthographic_height;
        result.orthographic.xmag =
            result.orthographic.ymag * (camera.aspect_ratio > 0.0 ? camera.aspect_ratio : 1.0);
        result.orthographic.znear = 0.0;
        result.orthographic.zfar = 1e6;
    } else {
        result.type = "perspective";
        result.perspective.yfov = camera.vertical_fov;
        result.perspective.aspectRatio = camera.aspect_ratio;  // 0 is not written
        result.perspective.znear = 0.01;
        // The library writes 0 where there is none, which is invalid: Blender shows black.
        result.perspective.zfar = 1e6;
    }
    if (auto plain = import::camera_of(result)) {
        plain->name = camera.name;
        set_extras(result.extras, import::CameraExtras, extras_of(camera, changed_fields(camera, *plain)));
    }
    model_.cameras.push_back(std::move(result));
    return entry->second = static_cast<int>(model_.cameras.size()) - 1;
}

}  // namespace tessera::exporting

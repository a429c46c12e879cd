#include "client/import/x3d_nodes.h"

#include <algorithm>
#include <string_view>

#include "client/import/limits.h"
#include "client/import/x3d_placement.h"

namespace tessera::import {

std::vector<ObjectId> X3dNodes::build() {
    std::vector<ObjectId> roots;
    for (const X3dDocument::Child& child : document_.children(document_.scene())) {
        Subtree subtree = node(child.node, 1);
        // The root has only transforms as children.
        if (subtree.id && subtree.height == 0)
            subtree = with_transform(x3d_name(child.node), glm::dmat4(1.0), subtree.id);
        if (subtree.id) roots.push_back(subtree.id);
    }
    return roots;
}

// Recursion ends at MaxNesting; a node that USE shares is built once.
X3dNodes::Subtree X3dNodes::node(pugi::xml_node node, std::size_t depth) {
    const X3dFields fields(node, document_.diagnostics());
    const auto found = subtrees_.find(node.internal_object());
    if (depth > MaxNesting || (found != subtrees_.end() && depth + found->second.height > MaxNesting)) {
        document_.diagnostics().add(
            "nodes nested more than " + std::to_string(MaxNesting) + " deep are not drawn: flatten the scene",
            node.offset_debug());
        return {};
    }
    if (found != subtrees_.end()) return found->second;
    const std::string_view kind = node.name();
    Subtree subtree;
    if (kind == "Transform" || kind == "Group") {
        subtree = group(node, depth);
    } else if (kind == "Shape") {
        subtree.id = shapes_.geometry(node);
    } else if (kind == "PointLight" || kind == "SpotLight" || kind == "DirectionalLight") {
        subtree = light(node);
    } else if (kind == "Viewpoint") {
        subtree = viewpoint(node);
    } else if (kind == "Background" && !background_) {
        background_ = node;
    } else {
        document_.diagnostics().skipped(node.name(), node.offset_debug());
    }
    subtrees_[node.internal_object()] = subtree;
    return subtree;
}

X3dNodes::Subtree X3dNodes::group(pugi::xml_node node, std::size_t depth) {
    scene::Transform transform;
    transform.name = x3d_name(node);
    if (std::string_view(node.name()) == "Transform")
        transform.matrix = transform_matrix(X3dFields(node, document_.diagnostics()));
    Subtree subtree;
    for (const X3dDocument::Child& child : document_.children(node)) {
        const Subtree below = this->node(child.node, depth + 1);
        subtree.height = std::max(subtree.height, below.height);
        if (below.id) transform.children.push_back(below.id);
    }
    ++subtree.height;
    subtree.id = builder_.add(std::move(transform));
    return subtree;
}

X3dNodes::Subtree X3dNodes::with_transform(std::string name, const glm::dmat4& matrix, ObjectId child) {
    scene::Transform transform;
    transform.name = std::move(name);
    transform.matrix = matrix;
    transform.children = {child};
    return {builder_.add(std::move(transform)), 1};
}

X3dNodes::Subtree X3dNodes::light(pugi::xml_node node) {
    const X3dFields fields(node, document_.diagnostics());
    const std::string_view kind = node.name();
    PlacedLight placed = kind == "PointLight"  ? point_light(fields)
                         : kind == "SpotLight" ? spot_light(fields)
                                               : directional_light(fields);
    if (placed.light.intensity == glm::vec3(0.0f)) return {};
    placed.light.name = x3d_name(node);
    const ObjectId id = builder_.add(std::move(placed.light));
    return with_transform(x3d_name(node), placed.parent_from_light, id);
}

X3dNodes::Subtree X3dNodes::viewpoint(pugi::xml_node node) {
    const X3dFields fields(node, document_.diagnostics());
    PlacedViewpoint placed = viewpoint_of(fields);
    placed.camera.name = x3d_name(node);
    if (placed.camera.name.empty()) placed.camera.name = x3d_name(fields.word("description", ""));
    const std::string name = placed.camera.name;
    const ObjectId id = builder_.add(std::move(placed.camera));
    return with_transform(name, placed.parent_from_camera, id);
}

}  // namespace tessera::import

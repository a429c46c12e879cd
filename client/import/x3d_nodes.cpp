#include "client/import/x3d_nodes.h"

#include <algorithm>
#include <string_view>

#include "client/import/limits.h"
#include "client/import/x3d_placement.h"

namespace tessera::import {

std::vector<ObjectId> X3dNodes::build() {
    std::vector<ObjectId> roots;
    for (const X3dDocument::Child& child : document_.children(document_.scene())) {
        Made made = node(child.node, 1);
        // The root holds transforms alone.
        if (made.id && made.height == 0) made = placed(x3d_name(child.node), glm::dmat4(1.0), made.id);
        if (made.id) roots.push_back(made.id);
    }
    return roots;
}

// Recursion ends at MaxNesting; what was made elsewhere is not entered again.
X3dNodes::Made X3dNodes::node(pugi::xml_node node, std::size_t depth) {
    const X3dFields fields(node, document_.problems());
    const auto found = made_.find(node.internal_object());
    if (depth > MaxNesting || (found != made_.end() && depth + found->second.height > MaxNesting)) {
        document_.problems().add(
            "nodes nested more than " + std::to_string(MaxNesting) + " deep are not drawn: flatten the scene",
            node.offset_debug());
        return {};
    }
    if (found != made_.end()) return found->second;
    const std::string_view kind = node.name();
    Made made;
    if (kind == "Transform" || kind == "Group") {
        made = group(node, depth);
    } else if (kind == "Shape") {
        made.id = shapes_.geometry(node);
    } else if (kind == "PointLight" || kind == "SpotLight" || kind == "DirectionalLight") {
        made = light(node);
    } else if (kind == "Viewpoint") {
        made = viewpoint(node);
    } else if (kind == "Background" && !background_) {
        background_ = node;
    } else {
        document_.problems().skipped(node.name(), node.offset_debug());
    }
    made_[node.internal_object()] = made;
    return made;
}

X3dNodes::Made X3dNodes::group(pugi::xml_node node, std::size_t depth) {
    scene::Transform transform;
    transform.name = x3d_name(node);
    if (std::string_view(node.name()) == "Transform")
        transform.matrix = transform_matrix(X3dFields(node, document_.problems()));
    Made made;
    for (const X3dDocument::Child& child : document_.children(node)) {
        const Made below = this->node(child.node, depth + 1);
        made.height = std::max(made.height, below.height);
        if (below.id) transform.children.push_back(below.id);
    }
    ++made.height;
    made.id = builder_.add(std::move(transform));
    return made;
}

X3dNodes::Made X3dNodes::placed(std::string name, const glm::dmat4& matrix, ObjectId child) {
    scene::Transform transform;
    transform.name = std::move(name);
    transform.matrix = matrix;
    transform.children = {child};
    return {builder_.add(std::move(transform)), 1};
}

X3dNodes::Made X3dNodes::light(pugi::xml_node node) {
    const X3dFields fields(node, document_.problems());
    const std::string_view kind = node.name();
    PlacedLight made = kind == "PointLight"  ? point_light(fields)
                       : kind == "SpotLight" ? spot_light(fields)
                                             : directional_light(fields);
    if (made.light.intensity == glm::vec3(0.0f)) return {};
    made.light.name = x3d_name(node);
    const ObjectId id = builder_.add(std::move(made.light));
    return placed(x3d_name(node), made.parent_from_light, id);
}

X3dNodes::Made X3dNodes::viewpoint(pugi::xml_node node) {
    const X3dFields fields(node, document_.problems());
    PlacedViewpoint made = viewpoint_of(fields);
    made.camera.name = x3d_name(node);
    if (made.camera.name.empty()) made.camera.name = x3d_name(fields.word("description", ""));
    const std::string name = made.camera.name;
    const ObjectId id = builder_.add(std::move(made.camera));
    return placed(name, made.parent_from_camera, id);
}

}  // namespace tessera::import

#include "client/import/x3d_shapes.h"

#include <string_view>

#include "client/import/tangents.h"
#include "client/import/x3d_face_set.h"
#include "client/import/x3d_fields.h"
#include "client/import/x3d_primitives.h"

namespace tessera::import {
namespace {

bool is_geometry(std::string_view kind) {
    for (const std::string_view known :
         {"IndexedFaceSet", "IndexedTriangleSet", "Box", "Sphere", "Cone", "Cylinder"}) {
        if (kind == known) return true;
    }
    return false;
}

MeshData read_mesh(X3dDocument& document, pugi::xml_node node) {
    const std::string_view kind = node.name();
    if (kind == "IndexedFaceSet") return mesh_of(read_face_set(document, node));
    if (kind == "IndexedTriangleSet") return mesh_of(read_triangle_set(document, node));
    return read_primitive(document, node).value_or(MeshData{});
}

// X3D's default texture coordinates, from the bounding box: s from 0 to 1 along the longest edge, t along the
// second longest with the same scale; of equal edges x precedes y precedes z.
void add_tex_coords(MeshData& mesh) {
    const Bounds bounds = bounds_of(mesh);
    const glm::dvec3 size = bounds.upper - bounds.lower;
    int s = 0;
    for (int i = 1; i < 3; ++i) {
        if (size[i] > size[s]) s = i;
    }
    int t = s == 0 ? 1 : 0;
    for (int i = t + 1; i < 3; ++i) {
        if (i != s && size[i] > size[t]) t = i;
    }
    const double scale = size[s] > 0.0 ? 1.0 / size[s] : 0.0;
    for (const glm::vec3& position : mesh.positions) {
        const glm::dvec3 normalized = (glm::dvec3(position) - bounds.lower) * scale;
        mesh.tex_coords.emplace_back(normalized[s], normalized[t]);
    }
}

// t points up in X3D and down here.
void transform_tex_coords(MeshData& mesh, const glm::dmat3& transform) {
    for (glm::vec2& coordinate : mesh.tex_coords) {
        const glm::dvec3 turned = transform * glm::dvec3(coordinate, 1.0);
        coordinate = glm::vec2(turned.x, 1.0 - turned.y);
    }
}

}  // namespace

ObjectId X3dShapes::geometry(pugi::xml_node shape) {
    pugi::xml_node geometry, appearance;
    for (const X3dDocument::Child& child : document_.children(shape)) {
        const std::string_view kind = child.node.name();
        if (kind == "Appearance" && !appearance) {
            appearance = child.node;
        } else if (is_geometry(kind) && !geometry) {
            geometry = child.node;
        } else {
            document_.diagnostics().skipped(child.node.name(), child.node.offset_debug());
        }
    }
    if (!geometry) return {};
    ObjectId& result = geometries_[{geometry.internal_object(), appearance.internal_object()}];
    if (!result) result = make(shape, geometry, appearance);
    return result;
}

ObjectId X3dShapes::make(pugi::xml_node shape, pugi::xml_node geometry, pugi::xml_node appearance) {
    const X3dFields fields(geometry, document_.diagnostics());
    try {
        MeshData mesh = read_mesh(document_, geometry);
        for (const std::string& repair : check_and_repair(mesh)) fields.report(repair);
        const X3dSurface surface =
            appearances_.surface(appearance, mesh.colors.empty() ? VertexColors::None : VertexColors::Given);
        if (!surface.is_textured) {
            mesh.tex_coords.clear();
        } else if (mesh.tex_coords.empty()) {
            add_tex_coords(mesh);
        }
        transform_tex_coords(mesh, surface.texture_transform);
        if (surface.needs_tangents) {
            if (mesh.normals.empty()) make_flat(mesh);
            generate_tangents(mesh);
        }
        const std::string name = x3d_name(shape);
        const ObjectId result =
            builder_.add_geometry(name.empty() ? x3d_name(geometry) : name, surface.material, mesh);
        builder_.get<scene::Geometry>(result).medium = surface.medium;
        return result;
    } catch (const Error& error) {
        if (error.code() != ErrorCode::InvalidInput) throw;
        fields.report("is invalid (" + std::string(error.what()) +
                      "): a magenta box replaces it, correct it");
        return builder_.placeholder_geometry();
    }
}

}  // namespace tessera::import

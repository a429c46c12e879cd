#include "client/import/x3d_face_set.h"

#include <cstring>
#include <numbers>
#include <optional>

#include "client/import/limits.h"
#include "client/import/x3d_fields.h"
#include "mediator/base/error.h"

namespace tessera::import {
namespace {

using Indices = std::vector<std::int32_t>;

[[noreturn]] void reject_face_set(const std::string& cause) {
    throw Error(ErrorCode::InvalidInput, cause);
}

std::uint32_t checked(std::int64_t index, std::size_t count, const char* what) {
    if (index < 0 || static_cast<std::uint64_t>(index) >= count) {
        reject_face_set("index " + std::to_string(index) + " is out of range for its " +
                        std::to_string(count) + " " + what);
    }
    return static_cast<std::uint32_t>(index);
}

// Reads the arrays of the child nodes: Coordinate, Normal and so on.
void read_arrays(X3dDocument& document, pugi::xml_node node, FaceSet& faces) {
    bool has_points = false;
    for (const X3dDocument::Child& child : document.children(node)) {
        const X3dFields fields(child.node, document.diagnostics());
        if (std::strcmp(child.node.name(), "Coordinate") == 0) {
            faces.positions = fields.vectors<glm::vec3>("point");
            has_points = true;
        } else if (std::strcmp(child.node.name(), "Normal") == 0) {
            faces.normals = fields.vectors<glm::vec3>("vector");
        } else if (std::strcmp(child.node.name(), "TextureCoordinate") == 0) {
            faces.tex_coords = fields.vectors<glm::vec2>("point");
        } else if (std::strcmp(child.node.name(), "Color") == 0) {
            for (const glm::vec3& color : fields.vectors<glm::vec3>("color"))
                faces.colors.emplace_back(color, 1.0f);
        } else if (std::strcmp(child.node.name(), "ColorRGBA") == 0) {
            faces.colors = fields.vectors<glm::vec4>("color");
        } else {
            document.diagnostics().skipped(child.node.name(), child.node.offset_debug());
        }
    }
    if (!has_points) reject_face_set("it has no Coordinate");
    for (const glm::vec4& color : faces.colors) {
        for (int i = 0; i < 4; ++i) {
            if (!(color[i] >= 0.0f && color[i] <= 1.0f))
                reject_face_set("a colour of a point is outside 0 to 1");
        }
    }
}

// Finds the index of one attribute for a corner or face.
class Lookup {
  public:
    Lookup(const Indices& indices, std::size_t count, bool per_vertex, const char* what)
        : indices_(indices), count_(count), per_vertex_(per_vertex), what_(what) {}

    // `slot`: the position of the corner in coordIndex.
    std::uint32_t at(std::size_t slot, std::size_t face, std::uint32_t position) const {
        if (count_ == 0) return FaceSet::None;
        if (indices_.empty())
            return checked(per_vertex_ ? std::int64_t{position} : std::int64_t(face), count_, what_);
        const std::size_t position_in_list = per_vertex_ ? slot : face;
        if (position_in_list >= indices_.size())
            reject_face_set(std::string("there are fewer indices of ") + what_ + " than corners or faces");
        return checked(indices_[position_in_list], count_, what_);
    }

  private:
    const Indices& indices_;
    std::size_t count_;
    bool per_vertex_;
    const char* what_;
};

// Splits a list of indices into faces and looks up the attributes of each corner.
class FaceSplitter {
  public:
    FaceSplitter(FaceSet& faces, Lookup normals, Lookup colors, Lookup tex_coords)
        : faces_(faces), normals_(normals), colors_(colors), tex_coords_(tex_coords) {}

    void add(std::int32_t index, std::size_t slot) {
        FaceSet::Corner corner;
        corner.position = checked(index, faces_.positions.size(), "points");
        corner.normal = normals_.at(slot, face_, corner.position);
        corner.color = colors_.at(slot, face_, corner.position);
        corner.tex_coord = tex_coords_.at(slot, face_, corner.position);
        faces_.corners.push_back(corner);
    }
    // Faces of one or two corners are dropped, but count in the numbering of faces.
    void end_face() {
        const std::size_t first = faces_.ends.empty() ? 0 : faces_.ends.back();
        if (faces_.corners.size() - first >= 3) {
            faces_.ends.push_back(faces_.corners.size());
        } else {
            faces_.corners.resize(first);
        }
        ++face_;
    }

  private:
    FaceSet& faces_;
    Lookup normals_, colors_, tex_coords_;
    std::size_t face_ = 0;
};

}  // namespace

FaceSet read_face_set(X3dDocument& document, pugi::xml_node node) {
    const X3dFields fields(node, document.diagnostics());
    FaceSet faces;
    read_arrays(document, node, faces);
    faces.shape = fields.flag("convex", true) ? PolygonShape::Convex : PolygonShape::Any;
    faces.counter_clockwise = fields.flag("ccw", true);
    faces.crease_angle = fields.number("creaseAngle", 0.0, NotNegative);
    const Indices coordinates = fields.whole_numbers("coordIndex"),
                  normals = fields.whole_numbers("normalIndex"), colors = fields.whole_numbers("colorIndex"),
                  tex_coords = fields.whole_numbers("texCoordIndex");
    FaceSplitter splitter(
        faces, Lookup(normals, faces.normals.size(), fields.flag("normalPerVertex", true), "normals"),
        Lookup(colors, faces.colors.size(), fields.flag("colorPerVertex", true), "colours"),
        Lookup(tex_coords, faces.tex_coords.size(), true, "texture coordinates"));
    for (std::size_t slot = 0; slot < coordinates.size(); ++slot) {
        if (coordinates[slot] < 0) {
            splitter.end_face();
        } else {
            splitter.add(coordinates[slot], slot);
        }
    }
    if (!coordinates.empty() && coordinates.back() >= 0) splitter.end_face();
    return faces;
}

FaceSet read_triangle_set(X3dDocument& document, pugi::xml_node node) {
    const X3dFields fields(node, document.diagnostics());
    FaceSet faces;
    read_arrays(document, node, faces);
    const bool normal_per_vertex = fields.flag("normalPerVertex", true);
    faces.counter_clockwise = fields.flag("ccw", true);
    faces.crease_angle = normal_per_vertex ? std::numbers::pi : 0.0;
    const Indices indices = fields.whole_numbers("index"), none;
    FaceSplitter splitter(faces, Lookup(none, faces.normals.size(), normal_per_vertex, "normals"),
                          Lookup(none, faces.colors.size(), fields.flag("colorPerVertex", true), "colours"),
                          Lookup(none, faces.tex_coords.size(), true, "texture coordinates"));
    for (std::size_t slot = 0; slot < indices.size() / 3 * 3; ++slot) {
        splitter.add(indices[slot], slot);
        if (slot % 3 == 2) splitter.end_face();
    }
    return faces;
}

}  // namespace tessera::import

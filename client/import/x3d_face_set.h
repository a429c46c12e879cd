#pragma once

#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "client/import/mesh_data.h"
#include "client/import/polygon.h"
#include "client/import/x3d_document.h"

namespace tessera::import {

// Polygons of an IndexedFaceSet or IndexedTriangleSet: each corner has its own indices of position, normal,
// colour and texture coordinate.
struct FaceSet {
    static constexpr std::uint32_t None = 0xffffffffu;
    struct Corner {
        std::uint32_t position = None, normal = None, color = None, tex_coord = None;
        friend bool operator==(const Corner&, const Corner&) = default;
    };

    std::vector<glm::vec3> positions, normals;
    std::vector<glm::vec4> colors;      // linear
    std::vector<glm::vec2> tex_coords;  // t up
    std::vector<Corner> corners;
    std::vector<std::size_t> ends;  // of each face, one past its last corner
    PolygonShape shape = PolygonShape::Convex;
    bool counter_clockwise = true;
    double crease_angle = 0.0;  // radians; without normals, edges below this angle are smooth
};

// Throws Error{InvalidInput} for invalid numbers, indices out of range and arrays that are too short.
FaceSet read_face_set(X3dDocument& document, pugi::xml_node node);
FaceSet read_triangle_set(X3dDocument& document, pugi::xml_node node);

// Merges equal corners into one vertex. Without normals, they are computed by the crease angle: face normals
// weighted by their angle at the corner. A crease angle of 0 means flat shading, without normals. If more
// than 1000 faces meet at a point, all of them are averaged.
MeshData mesh_of(FaceSet faces);

}  // namespace tessera::import

#pragma once

#include <string>

#include "tests/import/inspect.h"
#include "tests/import/scene_file.h"

namespace tessera::import {

inline std::string x3d(const std::string& scene, const std::string& version = "3.3") {
    return "<?xml version='1.0' encoding='UTF-8'?>\n<X3D version='" + version + "'><Scene>\n" + scene +
           "\n</Scene></X3D>\n";
}

// Imports a scene with these nodes, and checks that the result is valid.
inline ImportedScene read_x3d(const std::string& scene, const ImportOptions& options = {}) {
    const TestFolder folder;
    ImportedScene read = loaded(folder.write("a.x3d", x3d(scene)), options);
    expect_consistent(read, options);
    expect_valid(read);
    return read;
}

// The corners of all triangles of a mesh.
inline std::vector<glm::vec3> points_of(const ImportedScene& scene, const scene::Geometry& geometry) {
    const auto positions = values<glm::vec3>(scene, geometry.positions);
    std::vector<glm::vec3> points;
    for (const std::uint32_t index : values<std::uint32_t>(scene, geometry.indices))
        points.push_back(positions.at(index));
    return points;
}

inline const scene::Geometry& only_geometry(const ImportedScene& scene) {
    const auto found = all<scene::Geometry>(scene);
    EXPECT_EQ(found.size(), 1u);
    static const scene::Geometry none;
    return found.empty() ? none : *found.front();
}

}  // namespace tessera::import

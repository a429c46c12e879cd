#pragma once

#include <filesystem>
#include <string_view>

#include "client/import/scene_builder.h"

namespace tessera::import {

bool is_assimp_extension(std::string_view extension);  // lower case, with its dot

// Only formats whose readers in assimp 5.2 stand damaged files: its PLY reader crashes and loops, OFF
// asserts. Brings a file of another format into the builder: nodes, triangles, normals (smooth below a crease
// of 45 degrees where there are none), texture coordinates, vertex colours and simple materials; the root's
// children are set. Reads only files inside the scene's folder. Throws Error.
void import_with_assimp(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include <filesystem>
#include <string_view>

#include "client/import/scene_builder.h"

namespace tessera::import {

bool is_assimp_extension(std::string_view extension);  // lower case, including the dot

// Imports formats whose readers in assimp 5.2 are robust against malformed files (its PLY reader crashes and
// hangs, its OFF reader asserts), in a child process with limits of memory and time, since a crash of assimp must not
// end this one: nodes, triangles, normals (generated with a crease angle of 45 degrees if
// missing), texture coordinates, vertex colours and simple materials; sets the root's children. Reads only
// files inside the scene's folder. Throws Error.
void import_with_assimp(const std::filesystem::path& file, SceneBuilder& builder);

// What that child does: for fuzzers, which have to see where a crash is.
void read_with_assimp(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Brings an X3D file (XML encoding) into the builder: what the README lists under X3D; other nodes are
// counted in notices, one for each kind. Returns the file's Background, or a black one; the options' take
// its place, so it is not even read where they name one. Throws Error.
scene::Background import_x3d(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Imports an X3D file (XML encoding). Unsupported nodes are skipped, with one notice per kind. Returns the
// file's Background, or a black one; it is not read if the options have a background or environment. Throws
// Error.
scene::Background import_x3d(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

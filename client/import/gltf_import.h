#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Imports the default scene of a glTF file; sets the root's children. Throws Error.
void import_gltf(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Brings the default scene of a glTF file into the builder; the root's children are set. Throws Error.
void import_gltf(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

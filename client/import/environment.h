#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Adds a latitude-longitude map as a Texture of RgbFloat texels. Negative and non-finite values become 0,
// with a notice. Throws Error naming the file.
ObjectId add_environment(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

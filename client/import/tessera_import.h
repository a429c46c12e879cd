#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Imports a .tessera file: every object as it was saved, with new ids in the same order. The background and
// environment of the options replace those of the file. If the options ask for it, a framing camera is added
// to a scene without camera. Throws Error.
void import_tessera(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

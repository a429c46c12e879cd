#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Brings a .tessera file into the builder: every object as it was saved, with new ids in the order of the old
// ones. The options' background and environment take the place of the file's; a camera that frames everything
// is added where there is none and the options ask for it; nothing else is. Throws Error.
void import_tessera(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Brings a PLY, text or binary of either byte order, into the builder as one mesh: x y z, nx ny nz, texture
// coordinates (u v, s t or texture_u texture_v; v up) and red green blue alpha per vertex (integers are sRGB,
// floats linear); polygons are cut into fans. Without normals it is drawn flat. Throws Error when the file is
// damaged.
void import_ply(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

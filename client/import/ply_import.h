#pragma once

#include <filesystem>

#include "client/import/scene_builder.h"

namespace tessera::import {

// Imports a PLY file, text or binary of either byte order, as one mesh: x y z, nx ny nz, texture coordinates
// (u v, s t or texture_u texture_v; v up) and red green blue alpha per vertex (integers are sRGB, floats
// linear); polygons become triangle fans. Without normals it is flat-shaded. Throws Error if the file is
// damaged.
void import_ply(const std::filesystem::path& file, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include "client/import/limited_process.h"
#include "client/import/scene_builder.h"

namespace tessera::import {

// What a builder in another process has collected before post_process. Objects and arrays are written as in a .tessera
// file, without its limits of size; `options` must be equal on both sides.
void send_scene(const ImportedScene& scene, const ByteSink& sink);

// Adds it to a builder without objects, after checking everything, as if it came from a damaged file. Throws Error.
void receive_scene(const ByteSource& source, SceneBuilder& builder);

}  // namespace tessera::import

#pragma once

#include "client/import/scene_builder.h"

namespace tessera::import {

// The last phase of every import: background and environment from the options, else from the file. If the
// options ask for it, adds a default environment to a scene without light (see EmissiveLights) and a framing
// camera to a scene without camera. Throws Error if the environment cannot be read or there is nothing to
// render.
void post_process(SceneBuilder& builder, scene::Background of_file = {});

// Adds a camera that sees all of `bounds` (if empty, a box of 1 m at the origin), and a notice.
void add_framing_camera(SceneBuilder& builder, const Bounds& bounds);

}  // namespace tessera::import

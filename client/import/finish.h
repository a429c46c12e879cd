#pragma once

#include "client/import/scene_builder.h"

namespace tessera::import {

// What every scene gets at the end: background and environment from the options, a soft sky when nothing
// shines, a camera that frames everything when there is none. Throws Error when the environment cannot be
// read or there is nothing to draw.
void finish(SceneBuilder& builder);

}  // namespace tessera::import

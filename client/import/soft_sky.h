#pragma once

#include "client/import/scene_builder.h"

namespace tessera::import {

// An environment for a scene that brings no light: the CIE's overcast sky (Moon and Spencer 1942), at the
// zenith three times as bright as at the horizon, over a ground that reflects a fifth of it. Forms of one
// colour can be told in it, which they cannot in a sky that is the same all around. Its irradiance on what
// faces up is pi x (0.8, 0.9, 1).
ObjectId add_soft_sky(SceneBuilder& builder);

}  // namespace tessera::import

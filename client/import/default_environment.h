#pragma once

#include "client/import/scene_builder.h"

namespace tessera::import {

// The environment of a scene without light: the CIE overcast sky (Moon and Spencer 1942), three times as
// bright at the zenith as at the horizon, over ground with a reflectance of 0.2. Unlike a uniform sky, it
// shades objects of one colour. The irradiance on a surface facing up is pi x (0.8, 0.9, 1).
ObjectId add_default_environment(SceneBuilder& builder);

}  // namespace tessera::import

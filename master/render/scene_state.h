#pragma once

#include "mediator/base/ids.h"

namespace tessera::master {

// The latest versions of a scene that may have changed ... (picture_effect.h).
struct LastEdits {
    Version lights_or_materials;  // radiance anywhere
    Version geometry;             // surfaces
};

// The scene in a film: what a filter's history of another version may still be used for.
struct SceneState {
    Version version;
    LastEdits edits;
};

}  // namespace tessera::master

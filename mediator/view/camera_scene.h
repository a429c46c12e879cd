#pragma once

#include "mediator/scene/scene.h"

namespace tessera::view {

// The part of a scene that viewers may read: its cameras, and the transforms above them. Placed cameras are the same as
// in the whole scene; attachments, geometry, lights and materials are left out. Same version, its own state hash.
scene::Scene camera_scene(const scene::Scene& scene);

}  // namespace tessera::view

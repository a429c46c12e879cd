#pragma once

#include "backends/embree/rays.h"
#include "mediator/backend/path_log.h"

namespace tessera::embree {

// The context of the shared transport (mediator/shading/transport.h), with a path log.
struct Context : backend::PathLogger, Rays {};

}  // namespace tessera::embree

#pragma once

#include "backends/embree/rays.h"
#include "mediator/backend/story.h"

namespace tessera::embree {

// What the shared transport asks of this back-end (mediator/shading/transport.h), when it is told of.
struct Context : backend::Teller, Rays {};

}  // namespace tessera::embree

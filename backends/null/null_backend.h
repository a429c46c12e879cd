#pragma once

#include "mediator/backend/backend.h"

namespace tessera::null_backend {

// Ids and gradients: a minimal back-end, and the template for a new one. It traces no rays, but its film
// depends on everything that a real one's depends on (scene content, view, pixel, sample), so cluster tests
// can use it.
backend::BackendEntry entry();

}  // namespace tessera::null_backend

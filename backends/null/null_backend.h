#pragma once

#include "mediator/backend/backend.h"

namespace tessera::null_backend {

// Ids and gradients: the smallest legal back-end and the template for a new one. It traces nothing, but its
// film depends on all that a real one's depends on (scene content, view, pixel, sample), so cluster tests can
// trust it.
backend::BackendEntry entry();

}  // namespace tessera::null_backend

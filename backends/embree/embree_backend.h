#pragma once

#include "mediator/backend/backend.h"

namespace tessera::embree {

// Path tracing on the CPU with Embree 3. Its kind names the instruction set and the CPU's vendor: equal kinds
// give equal bits. Settings: isa "avx2" or "avx512" pins the instruction set.
backend::BackendEntry entry();

}  // namespace tessera::embree

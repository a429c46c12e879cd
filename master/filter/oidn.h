#pragma once

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Intel Open Image Denoise, where it is installed: a neural network for HDR colour with noisy albedo and normals. Runs on
// the CPU, through oidn/library.h. Alpha is filtered by a second execution, as one more picture with the same features; what
// it is in pixels around which it does not vary stays exactly so. Neither the same bits on different machines nor a
// bound for its memory can be promised: both are the library's.
FilterEntry oidn_entry();

}  // namespace tessera::filter

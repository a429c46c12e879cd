#pragma once

namespace tessera {

// For programs that take and free buffers of film and pictures all the time: the C library keeps what was
// freed, up to 256 MiB, instead of giving every large buffer back to the kernel, which hands it out again
// cleared and in pages of 4 KiB. That was a fifth of the processor time of a wall's frame
// (tessera bench displays). Call it first.
void keep_freed_memory();

}  // namespace tessera

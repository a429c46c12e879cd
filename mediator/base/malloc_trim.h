#pragma once

namespace tessera {

// For programs that constantly allocate and free film and picture buffers: malloc keeps up to 256 MiB of freed memory
// instead of returning every large buffer to the kernel, which would map it again as cleared 4 KiB pages. That took a
// fifth of the CPU time of a display wall's frame (tessera bench displays). Call it first.
void disable_malloc_trim();

}  // namespace tessera

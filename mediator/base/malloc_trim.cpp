#include "mediator/base/malloc_trim.h"

#include <malloc.h>

namespace tessera {

void disable_malloc_trim() {
    ::mallopt(M_MMAP_THRESHOLD, 32 << 20);
    ::mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

}  // namespace tessera

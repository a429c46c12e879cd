#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

#include "mediator/base/float_mode.h"

namespace tessera {

// Runs function(i) for i in [0, count) in the given arena, in the standard floating-point mode; the arena is always passed in,
// never global.
template <class Function>
void parallel_for(tbb::task_arena& arena, std::size_t count, const Function& function) {
    arena.execute([&] {
        tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
            const StandardFloatMode mode;
            function(i);
        });
    });
}

}  // namespace tessera

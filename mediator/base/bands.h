#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>

#include "mediator/base/float_mode.h"

namespace tessera {

// Runs function(first, last) for bands of [0, count), each of `band` or fewer: in the arena, or, without one, one after
// another in this thread. The same bands either way, in the standard floating-point mode.
template <class Function>
void for_bands(tbb::task_arena* arena, std::size_t count, std::size_t band, const Function& function) {
    const std::size_t bands = (count + band - 1) / band;
    const auto run = [&](std::size_t i) {
        const StandardFloatMode mode;
        function(i * band, std::min(count, (i + 1) * band));
    };
    if (arena == nullptr) {
        for (std::size_t i = 0; i < bands; ++i) run(i);
    } else {
        arena->execute([&] { tbb::parallel_for(std::size_t{0}, bands, run); });
    }
}

}  // namespace tessera

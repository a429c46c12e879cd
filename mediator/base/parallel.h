#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace tessera {

// Runs body(i) for i in [0, count) in the given arena; the arena is always passed in, never global.
template <class Body>
void parallel_for(tbb::task_arena& arena, std::size_t count, const Body& body) {
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) { body(i); }); });
}

}  // namespace tessera

#pragma once

#include <vector>

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Scratch memory for each thread of an arena, allocated before the threads start: allocation on first use
// would allocate again whenever a new thread joins the arena.
class Scratch {
  public:
    void reserve(RunContext& context, std::size_t numbers) {
        slots_.resize(static_cast<std::size_t>(context.arena.max_concurrency()));
        for (std::vector<float>& slot : slots_) slot.resize(numbers);
    }
    // The slot of the calling thread, which must run in the arena given to reserve().
    float* local() {
        return slots_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())].data();
    }

  private:
    std::vector<std::vector<float>> slots_;
};

}  // namespace tessera::filter

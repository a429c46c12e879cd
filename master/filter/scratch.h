#pragma once

#include <vector>

#include "mediator/filter/filter.h"

namespace tessera::filter {

// Numbers that a thread of an arena may overwrite, made before the threads start: a pool that grows with the
// first use by a thread would allocate whenever another thread comes to help.
class Scratch {
  public:
    void reserve(RunContext& context, std::size_t numbers) {
        slots_.resize(static_cast<std::size_t>(context.arena.max_concurrency()));
        for (std::vector<float>& slot : slots_) slot.resize(numbers);
    }
    // Of the thread that asks, which runs in the arena of `reserve`.
    float* local() {
        return slots_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())].data();
    }

  private:
    std::vector<std::vector<float>> slots_;
};

}  // namespace tessera::filter

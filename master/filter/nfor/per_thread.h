#pragma once

#include <vector>

#include "mediator/filter/filter.h"

namespace tessera::filter::nfor {

// One T for each thread of an arena, created before the threads start (see Scratch).
template <class T>
class PerThread {
  public:
    // prepare(T&) allocates what the thread will need.
    template <class Prepare>
    void reserve(RunContext& context, const Prepare& prepare) {
        slots_.resize(static_cast<std::size_t>(context.arena.max_concurrency()));
        for (T& slot : slots_) prepare(slot);
    }
    // The slot of the calling thread, which must run in the arena given to reserve().
    T& local() { return slots_[static_cast<std::size_t>(tbb::this_task_arena::current_thread_index())]; }

  private:
    std::vector<T> slots_;
};

}  // namespace tessera::filter::nfor

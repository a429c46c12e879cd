#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "mediator/backend/backend.h"
#include "mediator/base/clock.h"
#include "node/node_state_machine.h"

namespace tessera::node {

// Threads that render one unit at a time each. `done` is called on these threads, once per started unit; exceptions of
// the back-end become text. The destructor stops the units being rendered and waits for them.
class WorkerPool {
  public:
    using Done = std::function<void(UnitId, UnitOutcome&&)>;
    WorkerPool(backend::Backend& backend, const Clock& clock, std::uint32_t workers, Done done);
    ~WorkerPool();

    // Thread-safe.
    void start(const view::View& view, const view::WorkUnit& unit);
    void stop(UnitId unit);  // a waiting unit ends without blocks

  private:
    struct Job {
        view::View view;
        view::WorkUnit unit;
        std::stop_source stop;
    };
    void work(std::stop_token end);
    UnitOutcome render(const Job& job);

    backend::Backend& backend_;
    const Clock& clock_;
    Done done_;
    std::mutex mutex_;  // protects waiting_ and stops_
    std::condition_variable_any wake_;
    std::deque<Job> waiting_;
    std::map<UnitId, std::stop_source> stops_;  // of waiting and running units
    std::vector<std::jthread> threads_;
};

}  // namespace tessera::node

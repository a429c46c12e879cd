#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace tessera {

// One thread that runs long tasks in order, in the standard floating-point mode: builds, pictures, disk access. The destructor drops waiting tasks and waits
// for the running one.
class TaskThread {
  public:
    TaskThread();
    ~TaskThread();
    void post(std::function<void()> task);  // thread-safe; the task must not throw

  private:
    void work(std::stop_token end);

    std::mutex mutex_;  // protects tasks_
    std::condition_variable_any wake_;
    std::deque<std::function<void()>> tasks_;
    std::jthread thread_;
};

}  // namespace tessera

#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace tessera {

// One thread for what takes long and has an order: builds, pictures, the disk. The destructor drops what waits
// and lets the task at hand end.
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

#include "mediator/base/task_thread.h"

#include <functional>

#include "mediator/base/float_mode.h"

namespace tessera {

TaskThread::TaskThread() : thread_([this](std::stop_token end) { work(end); }) {}

TaskThread::~TaskThread() {
    thread_.request_stop();
    thread_.join();
}

void TaskThread::post(std::function<void()> task) {
    {
        const std::scoped_lock lock(mutex_);
        tasks_.push_back(std::move(task));
    }
    wake_.notify_one();
}

void TaskThread::work(std::stop_token end) {
    const StandardFloatMode mode;
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, end, [this] { return !tasks_.empty(); }) && !end.stop_requested()) {
        const std::function<void()> task = std::move(tasks_.front());
        tasks_.pop_front();
        lock.unlock();
        task();
        lock.lock();
    }
}

}  // namespace tessera

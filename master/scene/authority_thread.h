#pragma once

#include <functional>
#include <memory>

#include "mediator/base/clock.h"
#include "mediator/base/task_thread.h"

namespace tessera::master {

// Work on the scene authority that takes long or waits for the disk, on a thread of its own. Meanwhile the authority
// belongs to that thread: the event loop reads the published scene (published_scene.h), and what needs the authority
// waits.
class AuthorityThread {
  public:
    // `returned` is called on the thread when the work is done: finish() is to be called in the loop then.
    explicit AuthorityThread(std::function<void()> returned) : returned_(std::move(returned)) {}

    bool is_busy() const { return static_cast<bool>(finish_); }
    // Runs `work`, which must not throw, on the thread, and `then` in finish(). Not while it is busy.
    void run(std::function<void()> work, std::function<void(TimePoint)> then);
    void finish(TimePoint now);

    // Destroys a large value on the thread: freeing 100,000 objects takes milliseconds.
    template <class T>
    void discard(T&& value) {
        thread_.post([kept = std::make_shared<std::decay_t<T>>(std::forward<T>(value))] {});
    }

  private:
    std::function<void()> returned_;
    std::function<void(TimePoint)> finish_;  // of the running work
    TaskThread thread_;                      // the last member, since its tasks use the others
};

}  // namespace tessera::master

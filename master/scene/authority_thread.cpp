#include "master/scene/authority_thread.h"

#include <utility>

#include "mediator/base/error.h"

namespace tessera::master {

void AuthorityThread::run(std::function<void()> work, std::function<void(TimePoint)> then) {
    if (is_busy()) throw Error(ErrorCode::Internal, "the scene authority is on its thread already");
    finish_ = std::move(then);
    thread_.post([this, work = std::move(work)] {
        work();
        returned_();
    });
}

void AuthorityThread::finish(TimePoint now) {
    // It may run the next work.
    if (const auto then = std::exchange(finish_, nullptr)) then(now);
}

}  // namespace tessera::master

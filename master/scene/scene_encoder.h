#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "master/peers/encoded_scene.h"
#include "mediator/base/task_thread.h"
#include "mediator/scene/change_list.h"

namespace tessera::master {

// Makes, encodes and hashes long change lists on a thread of its own: for 300,000 objects that takes seconds, which the
// event loop does not have.
class SceneEncoder {
  public:
    // Lists with fewer entries are encoded by the caller, within a few milliseconds.
    static constexpr std::size_t ShortList = 512;

    using Deliver = std::function<void(EncodedScene)>;
    explicit SceneEncoder(Deliver deliver) : deliver_(std::move(deliver)) {}

    // `make` runs on the thread and owns all that it reads. The result comes through `deliver`, on that thread. Returns
    // the number of the job, never 0.
    std::uint64_t encode(Version from, Version to, std::function<scene::ChangeList()> make);

  private:
    Deliver deliver_;
    std::uint64_t jobs_ = 0;
    TaskThread thread_;  // the last member, since its tasks use the others
};

}  // namespace tessera::master

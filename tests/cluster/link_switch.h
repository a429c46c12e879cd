#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "mediator/net/channel.h"

namespace tessera::test {

// A client's link that a test can stall or cut while it is used. Both may be called on any thread.
class LinkSwitch {
  public:
    // Bulk messages of both directions wait, as on a line that is full; control messages pass.
    void stall_bulk(bool stalls) { stalls_ = stalls; }
    // Messages of both directions are lost without a word until the client reconnects.
    void cut() { is_cut_ = true; }

    using Open = std::function<std::unique_ptr<net::Channel>()>;
    std::unique_ptr<net::Channel> channel(const Open& open);  // once
    void reconnect();                                         // on the thread that uses the channel

  private:
    class Switched;
    std::atomic<bool> stalls_ = false, is_cut_ = false;
    Switched* channel_ = nullptr;
};

}  // namespace tessera::test

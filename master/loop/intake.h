#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "mediator/base/clock.h"
#include "mediator/net/channel.h"

namespace tessera::master {

// Received messages that wait for the event loop, fairly between keys: the next one is of the key that has used the
// least time of the loop, so that a key whose messages are many, or costly, delays its own only. In order per key and
// link. One thread.
class Intake {
  public:
    static constexpr std::size_t MaxMessages = 16384,
                                 MaxBytes = std::size_t{64}
                                            << 20;  // that may wait, per key: a thousand nodes may share one

    // Takes it. False: too many messages of its key wait; the message is left as it is.
    bool put(net::Message& message);
    bool empty() const { return waiting_ == 0; }
    net::Message take();                                 // not when empty
    void used(const std::string& user, Duration spent);  // by a message that was taken

  private:
    struct Key {
        std::deque<net::Message> messages;
        std::size_t bytes = 0;
        Duration used{};
    };
    std::map<std::string, Key> keys_;
    Duration served_{};  // the time used by the key that was served last: those that come back begin there
    std::size_t waiting_ = 0;
};

}  // namespace tessera::master

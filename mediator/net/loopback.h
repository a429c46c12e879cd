#pragma once

#include <memory>

#include "mediator/net/channel.h"

namespace tessera::net {

// Channels inside one process without sockets, for tests: every queue is bounded, order within a link is
// kept.
class LoopbackHub {
  public:
    struct Limits {
        std::size_t messages_per_queue = 1024;
    };
    LoopbackHub();
    explicit LoopbackHub(Limits limits);
    ~LoopbackHub();

    std::unique_ptr<Channel> server();  // once
    std::unique_ptr<Channel> client(Role role,
                                    const std::string& user = {});  // any number; `user`: of the key

    struct State;

  private:
    std::shared_ptr<State> state_;
};

}  // namespace tessera::net

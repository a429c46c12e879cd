#pragma once

#include <atomic>
#include <mutex>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "mediator/net/zap.h"

namespace tessera::net {

// See zmq_channel.h. Starts the ZAP handler at the first server with keys.
class ZmqContext {
  public:
    explicit ZmqContext(int io_threads) : context_(io_threads) {}
    zmq::context_t& zmq() { return context_; }
    ZapHandler& zap();
    std::string new_domain() { return "tessera-" + std::to_string(++domains_); }

  private:
    zmq::context_t context_;
    std::atomic<int> domains_{0};
    std::mutex mutex_;  // protects the members below
    std::optional<ZapHandler> zap_;
};

}  // namespace tessera::net

#pragma once

#include <array>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "mediator/base/error.h"
#include "mediator/net/channel.h"

// What servers and clients share: addresses, socket options, waiting.
namespace tessera::net {

struct Addresses {
    std::string control, bulk;
    bool is_tcp = false, is_loopback = false;  // inproc is neither
};
// Of "tcp://host:port" or "inproc://name"; throws Error{InvalidInput}.
Addresses addresses_of(const std::string& endpoint);

std::size_t limit_of(Link link);

// The one place that sets socket options: non-blocking with ROUTER_MANDATORY (else a full or unknown peer
// loses messages in silence), bounded linger, high-water marks from a byte budget, message sizes.
void configure(zmq::socket_t& socket, Link link);

// An eventfd that interrupts a wait from another thread.
class WakeSignal {
  public:
    WakeSignal();
    ~WakeSignal();
    WakeSignal(const WakeSignal&) = delete;
    WakeSignal& operator=(const WakeSignal&) = delete;
    void raise();  // thread-safe
    bool take();   // was raised since the last take
    int descriptor() const { return descriptor_; }

  private:
    int descriptor_;
};

// Waits until a socket is readable, the signal is raised or the deadline has passed.
void wait_readable(std::array<zmq::socket_t, 2>& sockets, const WakeSignal& signal, TimePoint deadline);

}  // namespace tessera::net

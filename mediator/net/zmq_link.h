#pragma once

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <zmq.hpp>

#include "mediator/base/error.h"
#include "mediator/net/channel.h"

// Shared by servers and clients: addresses, socket options, waiting.
namespace tessera::net {

struct Addresses {
    std::string control, bulk;
    bool is_tcp = false, is_loopback = false;  // inproc is neither
    bool is_ipv6 = false;                      // written as [address]
};
// Of "tcp://host:port" or "inproc://name"; throws Error{InvalidInput}.
Addresses addresses_of(const std::string& endpoint);

// Throws Error{Refused} for unencrypted TCP to other machines.
enum class Keys { Absent, Present };
void require_keys(const std::string& endpoint, const Addresses& addresses, Keys keys);

std::size_t limit_of(Link link);

// Bytes that may be queued per peer, link and direction, assuming messages of maximum length.
inline constexpr std::size_t QueueBudget = 64 * 1024 * 1024;
int queue_limit(Link link);

// The one place that sets socket options: non-blocking with ROUTER_MANDATORY (else messages to a full or unknown
// peer are lost silently), bounded linger, high-water marks from a byte budget, message sizes.
void configure(zmq::socket_t& socket, Link link, const Addresses& addresses);

// Of a whole message: WouldBlock when the queue is full, Closed when ROUTER does not know the routing id.
// `routing_id` is null for a DEALER. Continues after a signal; throws Error{Internal}.
SendResult send_message(zmq::socket_t& socket, const std::string* routing_id, const Bytes& bytes);

// Non-blocking; false if there is none. `parts` counts all, only the first `size()` of them are kept.
template <std::size_t Count>
struct Parts {
    std::array<zmq::message_t, Count> kept;
    std::size_t count = 0;
};
bool receive_part(zmq::socket_t& socket, zmq::message_t& part);
template <std::size_t Count>
bool receive_message(zmq::socket_t& socket, Parts<Count>& parts) {
    parts.count = 0;
    zmq::message_t excess;
    do {
        if (!receive_part(socket, parts.count < Count ? parts.kept[parts.count] : excess)) return false;
        ++parts.count;
    } while (socket.get(zmq::sockopt::rcvmore));
    return true;
}

// An eventfd that interrupts a wait from another thread.
class WakeSignal {
  public:
    WakeSignal();
    ~WakeSignal();
    WakeSignal(const WakeSignal&) = delete;
    WakeSignal& operator=(const WakeSignal&) = delete;
    void raise();                                    // thread-safe
    bool take() { return raised_.exchange(false); }  // true if raised since the last take()
    // A wait that it has ended calls this. The flag of this write has been set before, and may have been taken.
    void drain();
    int descriptor() const { return descriptor_; }

  private:
    int descriptor_;
    std::atomic<bool> raised_ = false;
};

// Waits until a socket is readable, the signal is raised or the deadline has passed.
void wait_readable(std::array<zmq::socket_t, 2>& sockets, WakeSignal& signal, TimePoint deadline);

}  // namespace tessera::net

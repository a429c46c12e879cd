#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "mediator/base/clock.h"

namespace tessera::net {

using Bytes = std::vector<std::byte>;

// A peer has two links on consecutive ports: control (small, in order) and bulk (large). There is no ordering between
// the two.
enum class Link : std::uint8_t { Control, Bulk };

// One remote end of one link, as this channel numbers it. A client channel has the one peer ServerPeer.
using PeerId = std::uint64_t;
inline constexpr PeerId ServerPeer = 0;

enum class Role : std::uint8_t { None, Viewer, Editor, Node, Operator };
const char* name(Role role);
Role role_named(std::string_view text);  // None for unknown names

struct Message {
    Link link = Link::Control;
    PeerId peer = ServerPeer;
    Role role = Role::None;  // proven by the transport (ZAP User-Id), never claimed by the content
    std::string user;        // the key's name in the allow-list; "" without CURVE
    Bytes bytes;
};

enum class SendResult { Sent, WouldBlock, Closed };
enum class NoMessage { Timeout, Woken, Closed };
using Received = std::variant<Message, NoMessage>;

// Moves messages between one server and many clients. All calls from one thread, except wake(). ZeroMQ and the loopback
// pass the same contract tests.
// Connections and messages that a server refused before anyone saw them.
struct RefusedTraffic {
    std::uint64_t handshakes = 0;  // of keys that are not on the allow-list
    std::uint64_t messages = 0;    // of revoked keys, or malformed
};

class Channel {
  public:
    virtual ~Channel() = default;

    // Never blocks. WouldBlock: the peer's queue is full, nothing was taken from `bytes`. Closed: no such
    // peer, or longer than the link's limit.
    virtual SendResult send(Link link, PeerId peer, Bytes&& bytes) = 0;
    virtual Received receive(TimePoint deadline) = 0;
    virtual void wake() = 0;  // thread-safe: the current or the next receive() returns Woken
    virtual void close() = 0;
};

inline constexpr std::size_t ControlLimit = 64 * 1024;
inline constexpr std::size_t BulkLimit = 1024 * 1024 + 4096;

}  // namespace tessera::net

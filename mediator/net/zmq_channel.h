#pragma once

#include <memory>
#include <optional>
#include <string>

#include "mediator/base/error.h"
#include "mediator/net/channel.h"
#include "mediator/net/keys.h"

namespace tessera::net {

// One ZeroMQ context for all channels of a process; inproc names are local to it. Must outlive the channels.
class ZmqContext;
// `io_threads`: that encrypt, decrypt and copy; one does about 600 MB/s.
std::shared_ptr<ZmqContext> make_zmq_context(int io_threads = 1);

// "tcp://host:port" (bulk on port + 1; port 0 is not allowed) or "inproc://name".
struct ServerSettings {
    std::string endpoint;
    std::optional<KeyDirectory>
        keys;  // CURVE + allow-list; without: loopback addresses and inproc only, everyone is Operator
};

struct ClientSettings {
    std::string endpoint;
    std::optional<ClientKeys> keys;
};

// A ROUTER pair; its ZAP handler runs before the bind. Throws Error{Refused} for a TCP endpoint
// without keys that is not loopback, Error{Unavailable} when the port is taken.
class ZmqServer : public Channel {
  public:
    // Called after SIGHUP. Revoked keys can no longer connect; libzmq cannot disconnect connected ones, so their messages
    // are dropped unread and sending to them returns Closed. Throws Error when the list cannot be
    // read; the old list then stays in force.
    virtual void reload_keys() = 0;
    virtual std::uint64_t refused_handshakes() const = 0;
    // Messages that were received and dropped unread.
    struct Dropped {
        std::uint64_t revoked = 0;    // of users who are no longer on the list
        std::uint64_t malformed = 0;  // not exactly one part, or too long
    };
    virtual Dropped dropped() const = 0;
};
std::unique_ptr<ZmqServer> make_zmq_server(std::shared_ptr<ZmqContext> context,
                                           const ServerSettings& settings);

// A DEALER pair. Connects in the background; reconnect() replaces both sockets: unsent messages are lost. Throws Error{Refused} like the server.
class ZmqClient : public Channel {
  public:
    virtual void reconnect() = 0;
};
std::unique_ptr<ZmqClient> make_zmq_client(std::shared_ptr<ZmqContext> context,
                                           const ClientSettings& settings);

}  // namespace tessera::net

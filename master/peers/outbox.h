#pragma once

#include <deque>
#include <map>
#include <utility>
#include <vector>

#include "mediator/net/channel.h"
#include "mediator/wire/messages.h"

namespace tessera::master {

// Sends in order per peer and link; messages that a full queue rejects wait here, bounded in bytes. One thread.
class Outbox {
  public:
    explicit Outbox(net::Channel& channel) : channel_(channel) {}

    // Throws Error{Internal} for a message longer than peers accept: a bug, which does not end the connection.
    void control(net::PeerId peer, const wire::ControlMessage& message);
    void control(net::PeerId peer, net::Bytes&& encoded);
    void bulk(net::PeerId peer, const wire::BulkMessage& message);
    void bulk(net::PeerId peer, net::Bytes&& encoded, std::uint64_t session::WireBytes::*counter);

    void flush();  // retries waiting messages
    bool waiting() const { return !queues_.empty(); }
    std::size_t waiting_bytes(net::Link link, net::PeerId peer) const;
    std::size_t waiting_bytes() const;  // of all peers
    void forget(net::Link link, net::PeerId peer) { queues_.erase({link, peer}); }

    // Peers that are unreachable or over the limit of waiting bytes, to be removed. Clears the list.
    std::vector<std::pair<net::Link, net::PeerId>> take_lost() { return std::exchange(lost_, {}); }

    session::WireBytes bytes;  // both directions; received bytes are added by the receiver

  private:
    void put(net::Link link, net::PeerId peer, net::Bytes&& message);

    struct Queue {
        std::deque<net::Bytes> messages;
        std::size_t bytes = 0;
    };
    net::Channel& channel_;
    std::map<std::pair<net::Link, net::PeerId>, Queue> queues_;
    std::vector<std::pair<net::Link, net::PeerId>> lost_;
};

inline constexpr std::size_t OutboxLimit = std::size_t{256} << 20;  // bytes that may wait for one peer

}  // namespace tessera::master

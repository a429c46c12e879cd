#include "tests/cluster/raw_peer.h"

namespace tessera::test {

void RawPeer::poll() {
    send(heartbeat);
    const auto now = std::chrono::steady_clock::now();
    for (auto event = channel_->receive(now + std::chrono::milliseconds(5));
         std::holds_alternative<net::Message>(event); event = channel_->receive(now)) {
        const net::Message& message = std::get<net::Message>(event);
        if (message.link == net::Link::Bulk) {
            if (auto bulk = wire::decode_bulk(message.bytes)) bulk_.push_back(std::move(*bulk));
        } else if (auto control = wire::decode_control(message.bytes)) {
            control_.push_back(std::move(*control));
        }
    }
}

}  // namespace tessera::test

#include "tests/cluster/raw_peer.h"

namespace tessera::test {

void RawPeer::poll() {
    constexpr int MaxMessages = 8;
    send(heartbeat);
    const auto now = std::chrono::steady_clock::now();
    for (int i = 0; i < MaxMessages; ++i) {
        const net::Received event = channel_->receive(i == 0 ? now + std::chrono::milliseconds(5) : now);
        if (!std::holds_alternative<net::Message>(event)) return;
        const net::Message& message = std::get<net::Message>(event);
        if (message.link == net::Link::Bulk) {
            if (auto bulk = wire::decode_bulk(message.bytes)) bulk_.push_back(std::move(*bulk));
        } else if (auto control = wire::decode_control(message.bytes)) {
            control_.push_back(std::move(*control));
        }
    }
}

}  // namespace tessera::test

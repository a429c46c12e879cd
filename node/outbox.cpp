#include "node/outbox.h"

namespace tessera::node {

void Outbox::film(UnitId unit, std::vector<net::Bytes>&& parts) {
    for (net::Bytes& part : parts) bulk_.push_back({std::move(part), unit, {}});
    bulk_.back().completes = unit;
}

void Outbox::hold() {
    held_ = true;
    control_.clear();
    std::erase_if(bulk_, [](const Item& item) { return !item.film_of; });
}

void Outbox::open(net::Bytes&& greeting) {
    held_ = false;
    bulk_.push_front({std::move(greeting), {}, {}});
}

void Outbox::discard_pending_film() {
    std::erase_if(bulk_, [](const Item& item) { return item.film_of.has_value(); });
}

std::vector<UnitId> Outbox::flush() {
    std::vector<UnitId> sent;
    flush(net::Link::Control, control_, sent);
    if (!held_) flush(net::Link::Bulk, bulk_, sent);
    return sent;
}

void Outbox::flush(net::Link link, std::deque<Item>& queue, std::vector<UnitId>& sent) {
    while (!queue.empty()) {
        // Closed: no peer, or the message is too long for the link; timeouts on either side handle both.
        if (channel_.send(link, net::ServerPeer, std::move(queue.front().bytes)) ==
            net::SendResult::WouldBlock)
            return;
        if (queue.front().completes) sent.push_back(*queue.front().completes);
        queue.pop_front();
    }
}

}  // namespace tessera::node

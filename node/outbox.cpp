#include "node/outbox.h"

#include <algorithm>

namespace tessera::node {

void Outbox::film(std::vector<UnitId> units, std::vector<net::Bytes>&& messages) {
    film_.push_back(
        {.messages = {std::make_move_iterator(messages.begin()), std::make_move_iterator(messages.end())},
         .units = std::move(units),
         .unwanted = {}});
}

void Outbox::hold() {
    held_ = true;
    control_.clear();
    bulk_.clear();
}

void Outbox::open(net::Bytes&& greeting) {
    held_ = false;
    bulk_.push_front(std::move(greeting));
    window_.restart();
}

void Outbox::discard_pending_film() {
    film_.clear();
}

std::vector<UnitId> Outbox::withdraw(UnitId unit) {
    const auto film = std::find_if(film_.begin(), film_.end(), [&](const Film& item) {
        return std::find(item.units.begin(), item.units.end(), unit) != item.units.end();
    });
    if (film == film_.end() || film->has_begun) return {};
    if (std::find(film->unwanted.begin(), film->unwanted.end(), unit) == film->unwanted.end())
        film->unwanted.push_back(unit);
    if (film->unwanted.size() < film->units.size()) return {};
    std::vector<UnitId> dropped = std::move(film->units);
    film_.erase(film);
    return dropped;
}

std::vector<UnitId> Outbox::flush(TimePoint now) {
    std::vector<UnitId> sent;
    send(net::Link::Control, control_);
    if (held_ || !send(net::Link::Bulk, bulk_)) return sent;
    while (!film_.empty() && window_.has_room()) {
        Film& film = film_.front();
        const std::size_t size = film.messages.front().size();
        if (channel_.send(net::Link::Bulk, net::ServerPeer, std::move(film.messages.front())) ==
            net::SendResult::WouldBlock)
            return sent;
        window_.sent(size, now);
        film.has_begun = true;
        film.messages.pop_front();
        if (!film.messages.empty()) continue;
        sent.insert(sent.end(), film.units.begin(), film.units.end());
        film_.pop_front();
    }
    return sent;
}

// False: the link takes no more for now. Closed (no peer, or a message too long for the link) is handled by timeouts on
// either side.
bool Outbox::send(net::Link link, std::deque<net::Bytes>& queue) {
    while (!queue.empty()) {
        if (channel_.send(link, net::ServerPeer, std::move(queue.front())) == net::SendResult::WouldBlock)
            return false;
        queue.pop_front();
    }
    return true;
}

}  // namespace tessera::node

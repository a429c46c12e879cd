#include "master/peers/session_table.h"

#include <algorithm>

namespace tessera::master {

void SessionTable::remove(SessionId id) {
    sessions_.erase(id);
    std::erase(queue_, id);
}

SessionRecord* SessionTable::find(SessionId id) {
    const auto it = sessions_.find(id);
    return it == sessions_.end() ? nullptr : &it->second;
}

SessionRecord* SessionTable::by_control(net::PeerId peer) {
    for (auto& [id, session] : sessions_) {
        if (session.control == peer) return &session;
    }
    return nullptr;
}

SessionRecord* SessionTable::by_bulk(net::PeerId peer) {
    for (auto& [id, session] : sessions_) {
        if (session.bulk == peer) return &session;
    }
    return nullptr;
}

SessionRecord* SessionTable::by_token(std::uint64_t token) {
    for (auto& [id, session] : sessions_) {
        if (session.token == token) return &session;
    }
    return nullptr;
}

void SessionTable::enqueue(SessionId id) {
    if (queue_position(id) == 0) queue_.push_back(id);
}

std::uint32_t SessionTable::queue_position(SessionId id) const {
    const auto it = std::find(queue_.begin(), queue_.end(), id);
    return it == queue_.end() ? 0 : static_cast<std::uint32_t>(it - queue_.begin()) + 1;
}

}  // namespace tessera::master

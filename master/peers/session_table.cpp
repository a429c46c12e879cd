#include "master/peers/session_table.h"

#include <algorithm>

namespace tessera::master {

void SessionTable::remove(SessionId id) {
    sessions_.erase(id);
    std::erase(queue_, id);
    if (on_stage_ == id) on_stage_.reset();
}

SessionRecord* SessionTable::find(SessionId id) {
    const auto place = sessions_.find(id);
    return place == sessions_.end() ? nullptr : &place->second;
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

void SessionTable::queue_for_stage(SessionId id) {
    if (on_stage_ == id || place(id) != 0) return;
    queue_.push_back(id);
}

std::optional<SessionId> SessionTable::next_on_stage() {
    if (!stage_is_free() || queue_.empty()) return std::nullopt;
    on_stage_ = queue_.front();
    queue_.pop_front();
    return on_stage_;
}

std::uint32_t SessionTable::place(SessionId id) const {
    const auto place = std::find(queue_.begin(), queue_.end(), id);
    return place == queue_.end() ? 0 : static_cast<std::uint32_t>(place - queue_.begin()) + 1;
}

}  // namespace tessera::master

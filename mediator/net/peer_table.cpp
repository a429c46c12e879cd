#include "mediator/net/peer_table.h"

namespace tessera::net {

PeerId PeerTable::number(const std::string& routing_id, const std::string& user_id, PeerId& next) {
    if (const auto known = numbers_.find(routing_id); known != numbers_.end()) {
        Entry& entry = peers_.at(known->second);
        if (entry.peer.user_id == user_id) {
            touch(entry);
            return known->second;
        }
        forget(PeerId{known->second});
    }
    if (peers_.size() >= limit_) forget(PeerId{uses_.front()});
    const PeerId peer = next++;
    numbers_[routing_id] = peer;
    peers_[peer] = {{routing_id, user_id}, uses_.insert(uses_.end(), peer)};
    return peer;
}

const PeerTable::Peer* PeerTable::find(PeerId peer) {
    const auto it = peers_.find(peer);
    if (it == peers_.end()) return nullptr;
    touch(it->second);
    return &it->second.peer;
}

void PeerTable::forget(PeerId peer) {
    const auto it = peers_.find(peer);
    if (it == peers_.end()) return;
    numbers_.erase(it->second.peer.routing_id);
    uses_.erase(it->second.use);
    peers_.erase(it);
}

}  // namespace tessera::net

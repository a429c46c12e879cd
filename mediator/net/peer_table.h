#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <unordered_map>

#include "mediator/net/channel.h"

namespace tessera::net {

// The peers of one link of a server, numbered by their first message. Bounded: the least recently used peer is evicted;
// it gets a new number with its next message and has to send Hello again.
class PeerTable {
  public:
    explicit PeerTable(std::size_t limit) : limit_(limit) {}

    struct Peer {
        std::string routing_id, user_id;
    };
    // Assigns and increments `next` for a new peer. A routing id used by another user is another peer, so that no user
    // gets messages meant for the previous one.
    PeerId number(const std::string& routing_id, const std::string& user_id, PeerId& next);
    const Peer* find(PeerId peer);  // counts as use; valid until the table changes
    void forget(PeerId peer);
    std::size_t count() const { return peers_.size(); }

  private:
    struct Entry {
        Peer peer;
        std::list<PeerId>::iterator use;
    };
    void touch(Entry& entry) { uses_.splice(uses_.end(), uses_, entry.use); }

    std::size_t limit_;
    std::unordered_map<PeerId, Entry> peers_;
    std::unordered_map<std::string, PeerId> numbers_;  // by routing id
    std::list<PeerId> uses_;                           // least recently used first
};

}  // namespace tessera::net

#pragma once

#include <cstddef>
#include <list>
#include <string>
#include <unordered_map>

#include "mediator/net/channel.h"

namespace tessera::net {

// The remote ends of one link of a server, numbered as they first speak. Bounded: whoever was unused for
// longest is forgotten first, gets a new number when it speaks again, and has to say hello once more.
class PeerTable {
  public:
    explicit PeerTable(std::size_t limit) : limit_(limit) {}

    struct Peer {
        std::string routing_id, user_id;
    };
    // Takes `next` and counts it up for an end that is new. A routing id under which another user speaks is
    // another end, so that nobody inherits what was said to the one before.
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
    std::list<PeerId> uses_;                           // the longest unused first
};

}  // namespace tessera::net

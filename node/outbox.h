#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/net/channel.h"

namespace tessera::node {

// What could not be sent yet, in order, per link. The bulk link is held while the master does not know who is
// at its end. Bounded by the work in hand and the requests in flight.
class Outbox {
  public:
    explicit Outbox(net::Channel& channel) : channel_(channel) {}

    void control(net::Bytes&& bytes) { control_.push_back({std::move(bytes), {}, {}}); }
    void bulk(net::Bytes&& bytes) { bulk_.push_back({std::move(bytes), {}, {}}); }
    void film(UnitId unit, std::vector<net::Bytes>&& parts);
    void hold();                       // new sockets: only film is worth keeping
    void open(net::Bytes&& greeting);  // goes first; ends the hold
    void drop_film();

    // Sends what goes; the units whose film is out completely.
    std::vector<UnitId> flush();
    bool blocked() const { return !control_.empty() || (!held_ && !bulk_.empty()); }

  private:
    struct Item {
        net::Bytes bytes;
        std::optional<UnitId> film_of;
        std::optional<UnitId> completes;
    };
    void flush(net::Link link, std::deque<Item>& queue, std::vector<UnitId>& sent);

    net::Channel& channel_;
    std::deque<Item> control_, bulk_;
    bool held_ = true;
};

}  // namespace tessera::node

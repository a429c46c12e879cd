#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/net/channel.h"

namespace tessera::node {

// Unsent messages, in order, per link. The bulk link is paused until the master has authenticated it. Bounded by the
// units and requests in flight.
class Outbox {
  public:
    explicit Outbox(net::Channel& channel) : channel_(channel) {}

    void control(net::Bytes&& bytes) { control_.push_back({std::move(bytes), {}, {}}); }
    void bulk(net::Bytes&& bytes) { bulk_.push_back({std::move(bytes), {}, {}}); }
    void film(UnitId unit, std::vector<net::Bytes>&& parts);
    void hold();                       // new sockets: keeps only film
    void open(net::Bytes&& greeting);  // sent first; resumes the bulk link
    void discard_pending_film();

    // Sends as much as possible; returns the units whose film was sent completely.
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

#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "mediator/base/ids.h"
#include "mediator/net/channel.h"
#include "node/film_window.h"

namespace tessera::node {

// Unsent messages, in order, per link; requests go before film. The bulk link is paused until the master has
// authenticated it. Film waits for room in the window of film in flight. Bounded by the units and requests in flight.
class Outbox {
  public:
    explicit Outbox(net::Channel& channel) : channel_(channel) {}

    void control(net::Bytes&& bytes) { control_.push_back(std::move(bytes)); }
    void bulk(net::Bytes&& bytes) { bulk_.push_back(std::move(bytes)); }
    // The messages complete these units.
    void film(std::vector<UnitId> units, std::vector<net::Bytes>&& messages);
    void hold();                       // new sockets: keeps only film
    void open(net::Bytes&& greeting);  // sent first; resumes the bulk link
    void discard_pending_film();
    // The unit's film is no longer needed. Returns the units whose film is dropped: it is kept if sending has begun, or
    // as long as it is needed for another unit.
    std::vector<UnitId> withdraw(UnitId unit);
    void film_taken(std::uint64_t bytes, TimePoint now) { window_.taken(bytes, now); }

    // Sends as much as possible; returns the units whose film was sent completely.
    std::vector<UnitId> flush(TimePoint now);
    // Messages could not be sent, and a retry may succeed.
    bool blocked() const {
        return !control_.empty() || (!held_ && (!bulk_.empty() || (!film_.empty() && window_.has_room())));
    }
    bool empty() const { return control_.empty() && bulk_.empty() && film_.empty(); }

  private:
    struct Film {
        std::deque<net::Bytes> messages;
        std::vector<UnitId> units;
        std::vector<UnitId> unwanted;  // of these
        bool has_begun = false;
    };
    bool send(net::Link link, std::deque<net::Bytes>& queue);

    net::Channel& channel_;
    std::deque<net::Bytes> control_, bulk_;
    std::deque<Film> film_;
    FilmWindow window_;
    bool held_ = true;
};

}  // namespace tessera::node

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "mediator/base/clock.h"
#include "mediator/display/display.h"

namespace tessera::tools {

// A UDP socket that receives trackers' packets (head_packet.h). Single-threaded.
class HeadSocket {
  public:
    struct Packets {
        std::optional<display::Head> newest;  // valid
        std::uint64_t good = 0, bad = 0;
        std::string problem;  // of the latest invalid packet, with its sender
    };

    // A numeric address of this machine, IPv4 or IPv6; port 0 = any free port. Throws Error{InvalidInput}
    // for other addresses, Error{Unavailable} if it cannot be bound.
    HeadSocket(const std::string& address, std::uint16_t port);
    ~HeadSocket();
    HeadSocket(const HeadSocket&) = delete;
    HeadSocket& operator=(const HeadSocket&) = delete;

    std::uint16_t port() const;
    void wait(Duration limit) const;  // until a packet arrives
    // Received packets, at most a thousand, so that a flood cannot block the caller. Never blocks.
    Packets drain();

  private:
    int socket_ = -1;
};

}  // namespace tessera::tools

#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "mediator/base/clock.h"
#include "mediator/display/display.h"

namespace tessera::tools {

// Where trackers send their packets (head_packet.h): a UDP socket. One thread.
class HeadSocket {
  public:
    struct Packets {
        std::optional<display::Head> newest;  // that could be read
        std::uint64_t good = 0, bad = 0;
        std::string problem;  // of the latest bad one, and who sent it
    };

    // A numeric address of this machine, IPv4 or IPv6; port 0 = one that is free. Throws Error{InvalidInput}
    // for another address, Error{Unavailable} when it cannot be had.
    HeadSocket(const std::string& address, std::uint16_t port);
    ~HeadSocket();
    HeadSocket(const HeadSocket&) = delete;
    HeadSocket& operator=(const HeadSocket&) = delete;

    std::uint16_t port() const;
    void wait(Duration limit) const;  // until a packet is there
    // What is there, at most a thousand packets, so that a flood cannot keep the caller. Never blocks.
    Packets drain();

  private:
    int socket_ = -1;
};

}  // namespace tessera::tools

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <variant>

#include "mediator/net/loopback.h"
#include "mediator/wire/envelope.h"

namespace tessera::client {

// The master's end of a client connection, scripted by the test: expects messages in order and sends replies.
class ScriptedMaster {
  public:
    explicit ScriptedMaster(net::LoopbackHub& hub) : channel_(hub.server()) {}

    // The next control message except heartbeats; the test fails if it is not a T.
    template <class T>
    T expect() {
        return std::get<T>(next_control(Heartbeats::Skip));
    }
    template <class T>
    T expect_bulk() {
        return std::get<T>(next_bulk());
    }
    int count_heartbeats(Duration during);

    void send(const wire::ControlMessage& message);
    void send(const wire::BulkMessage& message);
    void send_raw(net::Link link, net::Bytes bytes);

    // The handshake up to the bulk link; returns the client's hello.
    wire::Hello greet(const wire::Welcome& welcome = {.peer_number = 7,
                                                      .token = 70,
                                                      .epoch = 1,
                                                      .heartbeat_interval = std::chrono::seconds(10),
                                                      .missed_heartbeats = 3});

  private:
    enum class Heartbeats { Skip, Take };
    net::Message next(net::Link link);
    wire::ControlMessage next_control(Heartbeats heartbeats);
    wire::BulkMessage next_bulk();  // except repeated tokens

    std::unique_ptr<net::Channel> channel_;
    std::optional<net::PeerId> control_, bulk_;
    bool bulk_is_open_ = false;
    std::vector<net::Message> kept_;  // received from the other link
};

}  // namespace tessera::client

#pragma once

#include <deque>
#include <stdexcept>
#include <string>

#include "mediator/net/loopback.h"
#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/envelope.h"

namespace tessera::test {

// The master's end of a loopback channel, driven step by step by a test. Sends heartbeats and serves
// blobs while it waits; other messages are queued for expect().
class ScriptedMaster {
  public:
    explicit ScriptedMaster(net::LoopbackHub& hub) : channel_(hub.server()) {}

    void send(const wire::ControlMessage& message) {
        if (channel_->send(net::Link::Control, control_peer_, wire::encode(message)) !=
            net::SendResult::Sent) {
            throw std::runtime_error("the scripted master could not send");
        }
    }
    void send_raw(net::Link link, net::Bytes bytes) {
        channel_->send(link, link == net::Link::Control ? control_peer_ : bulk_peer_, std::move(bytes));
    }

    // The next control message of this kind; messages of other kinds are skipped. Throws after a generous
    // while.
    template <class M>
    M expect() {
        return next<M>(control_);
    }
    template <class M>
    M expect_bulk() {
        return next<M>(bulk_);
    }
    // Waits for a heartbeat that satisfies the predicate.
    template <class Predicate>
    wire::Heartbeat expect_heartbeat(const Predicate& wanted) {
        for (;;) {
            const wire::Heartbeat beat = expect<wire::Heartbeat>();
            if (wanted(beat)) return beat;
        }
    }

    wire::Hello welcome(std::uint64_t number = 1) {
        const wire::Hello hello = expect<wire::Hello>();
        send(wire::Welcome{.peer_number = number,
                           .token = 100 + number,
                           .epoch = 1,
                           .heartbeat_interval = std::chrono::milliseconds(50),
                           .missed_heartbeats = 40});
        return hello;
    }

    // Whether it answers.
    scene::BlobStore blobs;
    bool heartbeats = true;

  private:
    template <class M, class Queue>
    M next(Queue& queue) {
        const TimePoint limit = clock_.now() + std::chrono::seconds(20);
        for (;;) {
            while (!queue.empty()) {
                auto message = std::move(queue.front());
                queue.pop_front();
                if (auto* wanted = std::get_if<M>(&message)) return std::move(*wanted);
            }
            if (clock_.now() > limit)
                throw std::runtime_error(std::string("nothing came: ") + __PRETTY_FUNCTION__);
            pump();
        }
    }

    void pump() {
        net::Received received = channel_->receive(clock_.now() + std::chrono::milliseconds(20));
        if (auto* message = std::get_if<net::Message>(&received)) {
            if (message->link == net::Link::Control) {
                control_peer_ = message->peer;
                auto decoded = wire::decode_control(message->bytes);
                if (!decoded) throw decoded.error();
                control_.push_back(std::move(*decoded));
            } else {
                bulk_peer_ = message->peer;
                auto decoded = wire::decode_bulk(message->bytes);
                if (!decoded) throw decoded.error();
                if (const auto* request = std::get_if<wire::BlobRequest>(&*decoded)) {
                    send_raw(net::Link::Bulk, wire::encode(wire::answer(*request, blobs)));
                } else {
                    bulk_.push_back(std::move(*decoded));
                }
            }
            known_ = true;
        }
        if (heartbeats && known_ && clock_.now() > heartbeat_at_) {
            heartbeat_at_ = clock_.now() + std::chrono::milliseconds(50);
            channel_->send(net::Link::Control, control_peer_, wire::encode(wire::Heartbeat{.sent_at = 1}));
        }
    }

    std::unique_ptr<net::Channel> channel_;
    SteadyClock clock_;
    net::PeerId control_peer_ = 0, bulk_peer_ = 0;
    bool known_ = false;
    TimePoint heartbeat_at_{};
    std::deque<wire::ControlMessage> control_;
    std::deque<wire::BulkMessage> bulk_;
};

}  // namespace tessera::test

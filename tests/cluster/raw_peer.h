#pragma once

#include <chrono>
#include <memory>
#include <variant>
#include <vector>

#include "mediator/net/channel.h"
#include "mediator/wire/envelope.h"

namespace tessera::test {

// A client that sends the test's messages, and all messages that it received.
class RawPeer {
  public:
    wire::Heartbeat heartbeat{.sent_at = 1};  // that poll() sends

    explicit RawPeer(std::unique_ptr<net::Channel> channel) : channel_(std::move(channel)) {}

    void send(const wire::ControlMessage& message) { send(net::Link::Control, wire::encode(message)); }
    void send(const wire::BulkMessage& message) { send(net::Link::Bulk, wire::encode(message)); }
    // Stores the messages of the next few milliseconds, a few at most, so that other peers of this thread send theirs in
    // time; sends a heartbeat.
    void poll();

    // The n-th message of that kind, if received.
    template <class T>
    const T* received(std::size_t n = 0) const {
        if (const T* message = nth<T>(control_, n)) return message;
        return nth<T>(bulk_, n);
    }
    template <class T>
    bool wait_for(std::size_t n = 0) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (received<T>(n) == nullptr && std::chrono::steady_clock::now() < deadline) poll();
        return received<T>(n) != nullptr;
    }
    // Opens both links; false: no answer. Resumes the session of the token, if given.
    bool connect(const std::string& name, std::uint64_t resume_token = 0) {
        send(wire::Hello{.name = name, .resume_token = resume_token});
        if (!wait_for<wire::Welcome>()) return false;
        send(wire::BulkHello{received<wire::Welcome>()->token});
        return true;
    }

  private:
    void send(net::Link link, net::Bytes&& bytes) {
        (void)channel_->send(link, net::ServerPeer, std::move(bytes));
    }
    template <class T, class Messages>
    static const T* nth(const Messages& messages, std::size_t n) {
        for (const auto& message : messages) {
            const T* found = std::visit(
                [](const auto& value) -> const T* {
                    if constexpr (std::is_same_v<decltype(value), const T&>) return &value;
                    return nullptr;
                },
                message);
            if (found != nullptr && n-- == 0) return found;
        }
        return nullptr;
    }

    std::unique_ptr<net::Channel> channel_;
    std::vector<wire::ControlMessage> control_;
    std::vector<wire::BulkMessage> bulk_;
};

}  // namespace tessera::test

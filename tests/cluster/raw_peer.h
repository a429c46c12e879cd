#pragma once

#include <chrono>
#include <memory>
#include <variant>
#include <vector>

#include "mediator/net/channel.h"
#include "mediator/wire/envelope.h"

namespace tessera::test {

// A client that the test plays message by message, and all that the master sent it.
class RawPeer {
  public:
    explicit RawPeer(std::unique_ptr<net::Channel> channel) : channel_(std::move(channel)) {}

    void say(const wire::ControlMessage& message) { say(net::Link::Control, wire::encode(message)); }
    void say(const wire::BulkMessage& message) { say(net::Link::Bulk, wire::encode(message)); }
    // Keeps what comes within a few milliseconds; heartbeats show that it is there.
    void listen();

    // The n-th message of that kind, if it came.
    template <class T>
    const T* heard(std::size_t n = 0) const {
        if (const T* message = nth<T>(control_, n)) return message;
        return nth<T>(bulk_, n);
    }
    template <class T>
    bool wait_for(std::size_t n = 0) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
        while (heard<T>(n) == nullptr && std::chrono::steady_clock::now() < deadline) listen();
        return heard<T>(n) != nullptr;
    }
    // Both links are open after it; false: no answer. Returns to the session of the token, if there is one.
    bool greet(const std::string& name, std::uint64_t resume_token = 0) {
        say(wire::Hello{.name = name, .resume_token = resume_token});
        if (!wait_for<wire::Welcome>()) return false;
        say(wire::BulkHello{heard<wire::Welcome>()->token});
        return true;
    }

  private:
    void say(net::Link link, net::Bytes&& bytes) {
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

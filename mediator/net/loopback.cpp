#include "mediator/net/loopback.h"

#include <array>
#include <condition_variable>
#include <deque>
#include <map>
#include <mutex>
#include <utility>

namespace tessera::net {

namespace {

std::size_t limit(Link link) {
    return link == Link::Control ? ControlLimit : BulkLimit;
}

}  // namespace

// Everybody's inboxes under one mutex: a test tool, not a fast path.
struct LoopbackHub::State {
    struct Inbox {
        std::array<std::deque<Message>, 2> queues;  // by link
        bool woken = false, closed = false;
    };
    Limits limits;
    std::mutex mutex;  // protects what stands below
    std::condition_variable changed;
    Inbox server;
    std::map<PeerId, Inbox> clients;
    std::map<PeerId, Role> roles;
    PeerId next_peer = 1;

    SendResult put(Inbox& inbox, Link link, Message&& message, Bytes& bytes) {
        auto& queue = inbox.queues[static_cast<std::size_t>(link)];
        if (inbox.closed) return SendResult::Closed;
        if (queue.size() >= limits.messages_per_queue) return SendResult::WouldBlock;
        message.bytes = std::move(bytes);
        queue.push_back(std::move(message));
        changed.notify_all();
        return SendResult::Sent;
    }

    Received take(Inbox& inbox, TimePoint deadline) {
        std::unique_lock lock(mutex);
        const auto ready = [&] {
            return inbox.closed || inbox.woken || !inbox.queues[0].empty() || !inbox.queues[1].empty();
        };
        changed.wait_until(lock, deadline, ready);
        if (inbox.closed) return NoMessage::Closed;
        for (auto& queue : inbox.queues) {
            if (queue.empty()) continue;
            Message message = std::move(queue.front());
            queue.pop_front();
            return message;
        }
        return std::exchange(inbox.woken, false) ? NoMessage::Woken : NoMessage::Timeout;
    }

    void wake(Inbox& inbox) {
        const std::scoped_lock lock(mutex);
        inbox.woken = true;
        changed.notify_all();
    }

    void close(Inbox& inbox) {
        const std::scoped_lock lock(mutex);
        inbox.closed = true;
        changed.notify_all();
    }
};

namespace {

class LoopbackServer final : public Channel {
  public:
    explicit LoopbackServer(std::shared_ptr<LoopbackHub::State> state) : state_(std::move(state)) {}
    ~LoopbackServer() override { state_->close(state_->server); }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (bytes.size() > limit(link)) return SendResult::Closed;
        const std::scoped_lock lock(state_->mutex);
        const auto client = state_->clients.find(peer);
        if (client == state_->clients.end() || state_->server.closed) return SendResult::Closed;
        return state_->put(client->second, link, {.link = link, .role = Role::Operator}, bytes);
    }
    Received receive(TimePoint deadline) override { return state_->take(state_->server, deadline); }
    void wake() override { state_->wake(state_->server); }
    void close() override { state_->close(state_->server); }

  private:
    std::shared_ptr<LoopbackHub::State> state_;
};

class LoopbackClient final : public Channel {
  public:
    LoopbackClient(std::shared_ptr<LoopbackHub::State> state, PeerId peer, LoopbackHub::State::Inbox& inbox)
        : state_(std::move(state)), peer_(peer), inbox_(inbox) {}
    ~LoopbackClient() override { state_->close(inbox_); }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (peer != ServerPeer || bytes.size() > limit(link)) return SendResult::Closed;
        const std::scoped_lock lock(state_->mutex);
        if (inbox_.closed) return SendResult::Closed;
        return state_->put(state_->server, link, {.link = link, .peer = peer_, .role = state_->roles[peer_]},
                           bytes);
    }
    Received receive(TimePoint deadline) override { return state_->take(inbox_, deadline); }
    void wake() override { state_->wake(inbox_); }
    void close() override { state_->close(inbox_); }

  private:
    std::shared_ptr<LoopbackHub::State> state_;
    PeerId peer_;
    LoopbackHub::State::Inbox& inbox_;  // a map's element: stays where it is
};

}  // namespace

LoopbackHub::LoopbackHub() : LoopbackHub(Limits{}) {}
LoopbackHub::LoopbackHub(Limits limits) : state_(std::make_shared<State>()) {
    state_->limits = limits;
}
LoopbackHub::~LoopbackHub() = default;

std::unique_ptr<Channel> LoopbackHub::server() {
    return std::make_unique<LoopbackServer>(state_);
}

std::unique_ptr<Channel> LoopbackHub::client(Role role) {
    const std::scoped_lock lock(state_->mutex);
    const PeerId peer = state_->next_peer++;
    state_->roles[peer] = role;
    return std::make_unique<LoopbackClient>(state_, peer, state_->clients[peer]);
}

}  // namespace tessera::net

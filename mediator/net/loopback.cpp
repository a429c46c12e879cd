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

// All inboxes under one mutex: a test tool, not optimised.
struct LoopbackHub::State {
    struct Inbox {
        std::array<std::deque<Message>, 2> queues;  // by link
        std::size_t turn = 0;
        bool woken = false, closed = false;
        std::condition_variable changed;  // one each: a message must not wake all who wait for others
    };
    struct Client {
        Role role = Role::None;
        std::string user;
        Inbox inbox;
    };

    explicit State(Limits queue_limits) : limits(queue_limits) {}

    const Limits limits;
    std::mutex mutex;  // protects the members below
    Inbox server;
    std::map<std::uint64_t, Client> clients;  // by number, from 1
    std::uint64_t next_client = 1;

    SendResult put(Inbox& inbox, Message&& message, Bytes& bytes) {
        auto& queue = inbox.queues[static_cast<std::size_t>(message.link)];
        if (inbox.closed) return SendResult::Closed;
        if (queue.size() >= limits.messages_per_queue) return SendResult::WouldBlock;
        message.bytes = std::move(bytes);
        queue.push_back(std::move(message));
        inbox.changed.notify_all();
        return SendResult::Sent;
    }

    Received take(Inbox& inbox, TimePoint deadline) {
        std::unique_lock lock(mutex);
        inbox.changed.wait_until(lock, deadline, [&] {
            return inbox.closed || inbox.woken || !inbox.queues[0].empty() || !inbox.queues[1].empty();
        });
        if (inbox.closed) return NoMessage::Closed;
        if (std::exchange(inbox.woken, false)) return NoMessage::Woken;
        // Alternates between the links, so that neither starves.
        for (int i = 0; i < 2; ++i) {
            auto& queue = inbox.queues[inbox.turn];
            inbox.turn = 1 - inbox.turn;
            if (queue.empty()) continue;
            Message message = std::move(queue.front());
            queue.pop_front();
            return message;
        }
        return NoMessage::Timeout;
    }

    void wake(Inbox& inbox) {
        const std::scoped_lock lock(mutex);
        inbox.woken = true;
        inbox.changed.notify_all();
    }

    void close(Inbox& inbox) {
        const std::scoped_lock lock(mutex);
        inbox.closed = true;
        for (auto& queue : inbox.queues) queue.clear();
        inbox.changed.notify_all();
    }
};

namespace {

// As over sockets, the two links of a client are two peers.
PeerId peer_of(std::uint64_t client, Link link) {
    return 2 * client + static_cast<PeerId>(link);
}

class LoopbackServer final : public Channel {
  public:
    explicit LoopbackServer(std::shared_ptr<LoopbackHub::State> state) : state_(std::move(state)) {}
    ~LoopbackServer() override { state_->close(state_->server); }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (bytes.size() > limit(link)) return SendResult::Closed;
        const std::scoped_lock lock(state_->mutex);
        const auto client = state_->clients.find(peer / 2);
        if (client == state_->clients.end() || peer != peer_of(client->first, link) ||
            state_->server.closed) {
            return SendResult::Closed;
        }
        return state_->put(client->second.inbox, {.link = link, .role = Role::Operator}, bytes);
    }
    Received receive(TimePoint deadline) override { return state_->take(state_->server, deadline); }
    void wake() override { state_->wake(state_->server); }
    void close() override { state_->close(state_->server); }

  private:
    std::shared_ptr<LoopbackHub::State> state_;
};

class LoopbackClient final : public Channel {
  public:
    LoopbackClient(std::shared_ptr<LoopbackHub::State> state, std::uint64_t number,
                   LoopbackHub::State::Client& client)
        : state_(std::move(state)), number_(number), client_(client) {}
    ~LoopbackClient() override {
        const std::scoped_lock lock(state_->mutex);
        state_->clients.erase(number_);
    }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (peer != ServerPeer || bytes.size() > limit(link)) return SendResult::Closed;
        const std::scoped_lock lock(state_->mutex);
        if (client_.inbox.closed) return SendResult::Closed;
        return state_->put(
            state_->server,
            {.link = link, .peer = peer_of(number_, link), .role = client_.role, .user = client_.user},
            bytes);
    }
    Received receive(TimePoint deadline) override { return state_->take(client_.inbox, deadline); }
    void wake() override { state_->wake(client_.inbox); }
    void close() override { state_->close(client_.inbox); }

  private:
    std::shared_ptr<LoopbackHub::State> state_;
    std::uint64_t number_;
    LoopbackHub::State::Client& client_;  // an element of a std::map: its address is stable
};

}  // namespace

LoopbackHub::LoopbackHub() : LoopbackHub(Limits{}) {}
LoopbackHub::LoopbackHub(Limits limits) : state_(std::make_shared<State>(limits)) {}
LoopbackHub::~LoopbackHub() = default;

std::unique_ptr<Channel> LoopbackHub::server() {
    return std::make_unique<LoopbackServer>(state_);
}

std::unique_ptr<Channel> LoopbackHub::client(Role role, const std::string& user) {
    const std::scoped_lock lock(state_->mutex);
    const std::uint64_t number = state_->next_client++;
    State::Client& client = state_->clients[number];
    client.role = role;
    client.user = user;
    return std::make_unique<LoopbackClient>(state_, number, client);
}

}  // namespace tessera::net

#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <variant>
#include <vector>

#include "client/session.h"
#include "mediator/net/channel.h"
#include "mediator/net/liveness.h"
#include "mediator/wire/messages.h"

namespace tessera::client {

// The connection is lost and is being re-established.
struct Interrupted {};
// The connection is back. Same session: the master kept its state, but messages may be lost. Otherwise the master
// created a new session.
struct Rejoined {
    bool same_session = false;
};
using Incoming = std::variant<wire::ControlMessage, wire::FrameTile, wire::FilmBlock, wire::PictureChunk,
                              wire::FrameHeader, wire::OutputPicture, wire::BlobChunk, wire::BlobAbsent,
                              Interrupted, Rejoined>;

// The session's thread: sends hello and heartbeats, reconnects after a timeout, serves blobs. Messages for the session
// wait in an inbox, in order per link. Its states:
//
//   Greeting   hello sent                 Welcome → Joined · silence → Away · Refusal → Over
//   Joined     all messages are sent      silence, Goodbye → Away · Unknown → Greeting
//   Away       back-off before a retry    → new sockets → Greeting
//   Over       failed for good: every call throws the reason
//
// Also Over after `connect_limit` without a first welcome, or later after `lost_limit` without any message.
class Link {
  public:
    Link(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
         std::shared_ptr<scene::BlobStore> blobs, const Clock& clock, const SessionSettings& settings);
    ~Link();

    // Any thread. Messages are queued while the connection is down.
    void send(const wire::ControlMessage& message);
    void send(net::Bytes encoded);  // a control message
    void ask(const wire::BlobRequest& request);
    std::uint64_t served_requests() const { return served_; }  // blob requests of the master
    bool is_away() const { return is_away_; }                  // reconnecting
    bool is_silent() const;  // the same, or the master's latest heartbeat is overdue
    std::uint64_t join();    // blocks until welcome; the session's number. Throws Error, also when stopped.
    // The next one; nothing at the deadline or when stopped. Throws Error when the link is over.
    std::optional<Incoming> next(TimePoint deadline, std::stop_token stop);

  private:
    enum class State { Greeting, Joined, Away };
    struct Outgoing {
        net::Link link;
        net::Bytes bytes;
    };

    void run(std::stop_token stop);
    bool step(std::stop_token stop);
    void receive(const net::Message& message, TimePoint now);
    void control(wire::ControlMessage&& message, TimePoint now);
    void welcome(const wire::Welcome& welcome, TimePoint now);
    void serve(const wire::BlobRequest& request);
    void greet(TimePoint now);
    void beat(TimePoint now);
    void watch(TimePoint now);  // timeouts and back-off
    void enter_away(TimePoint now);
    void push(const wire::ControlMessage& message);
    void flush();
    TimePoint next_wake(TimePoint now) const;
    void deliver(Incoming incoming);
    void fail(Error error);

    // Used by the thread only:
    std::unique_ptr<net::Channel> channel_;
    std::function<void()> reconnect_;
    std::shared_ptr<scene::BlobStore> blobs_;
    const Clock& clock_;
    SessionSettings settings_;
    State state_ = State::Greeting;
    net::Liveness liveness_;
    std::deque<Outgoing> outbox_;
    std::uint64_t number_ = 0, token_ = 0;  // of the latest welcome
    // Reconnecting since, or the latest message while connected or after that.
    TimePoint lost_since_, return_at_{}, last_greeting_{};
    std::int64_t master_sent_at_ = 0;
    TimePoint master_heard_at_{};

    std::optional<std::string> goodbye_;  // the master left with this reason, and may come back
    std::atomic<std::uint64_t> served_ = 0;
    std::atomic<bool> is_away_ = false;
    std::atomic<TimePoint> last_heard_;
    std::atomic<Duration> heartbeat_;

    std::mutex mutex_;  // protects the members below
    std::condition_variable_any changed_;
    std::vector<net::Bytes> to_send_;  // control messages
    std::vector<wire::BlobRequest> to_ask_;
    std::deque<Incoming> inbox_;
    std::optional<Error> failure_;
    std::uint64_t joined_ = 0;  // number of the first welcome

    std::jthread thread_;  // last member: starts after all others are constructed
};

}  // namespace tessera::client

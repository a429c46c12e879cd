#include "client/link.h"

#include <algorithm>
#include <functional>

#include "mediator/wire/blob_transfer.h"
#include "mediator/wire/envelope.h"

namespace tessera::client {

namespace {

// Limit of queued chunks on a slow connection; the master requests dropped ones again.
constexpr std::size_t MaxWaitingMessages = 64;

net::LivenessSettings liveness_settings(Duration interval, std::uint32_t missed) {
    net::LivenessSettings settings;
    settings.interval = interval;
    settings.missed = static_cast<int>(missed);
    return settings;
}

}  // namespace

Link::Link(std::unique_ptr<net::Channel> channel, std::function<void()> reconnect,
           std::shared_ptr<scene::BlobStore> blobs, const Clock& clock, const SessionSettings& settings)
    : channel_(std::move(channel)),
      reconnect_(std::move(reconnect)),
      blobs_(std::move(blobs)),
      clock_(clock),
      settings_(settings),
      liveness_(liveness_settings(settings.heartbeat, 3), clock.now()),
      lost_since_(clock.now()),
      last_heard_(clock.now()),
      heartbeat_(settings.heartbeat),
      thread_([this](std::stop_token stop) { run(stop); }) {}

Link::~Link() {
    thread_.request_stop();
    channel_->wake();
    thread_.join();
}

void Link::send(const wire::ControlMessage& message) {
    send(wire::encode(message));
}

void Link::send(net::Bytes encoded) {
    {
        const std::scoped_lock lock(mutex_);
        to_send_.push_back(std::move(encoded));
    }
    channel_->wake();
}

void Link::ask(const wire::BlobRequest& request) {
    {
        const std::scoped_lock lock(mutex_);
        to_ask_.push_back(request);
    }
    channel_->wake();
}

std::uint64_t Link::join() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, settings_.stop, [&] { return joined_ != 0 || failure_; });
    if (failure_) throw *failure_;
    if (joined_ == 0) throw Error(ErrorCode::Unavailable, "interrupted before the master has answered");
    return joined_;
}

std::optional<Incoming> Link::next(TimePoint deadline, std::stop_token stop) {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, stop, deadline, [&] { return !inbox_.empty() || failure_; });
    if (!inbox_.empty()) {
        Incoming incoming = std::move(inbox_.front());
        inbox_.pop_front();
        return incoming;
    }
    if (failure_) throw *failure_;
    return std::nullopt;
}

bool Link::is_silent() const {
    return is_away_ || clock_.now() - last_heard_.load() > 3 * heartbeat_.load() / 2;
}

void Link::run(std::stop_token stop) {
    try {
        greet(clock_.now());
        while (!stop.stop_requested() && step(stop)) {
        }
        if (state_ == State::Joined) {
            push(wire::Goodbye{"done", {}});
            flush();
        }
    } catch (const Error& error) {
        fail(error);
    } catch (const std::exception& error) {
        fail(Error(ErrorCode::Internal, error.what()));
    }
}

bool Link::step(std::stop_token stop) {
    constexpr int BurstLimit = 256;  // so that a flood of messages does not delay heartbeats
    TimePoint deadline = next_wake(clock_.now());
    for (int i = 0; i < BurstLimit; ++i) {
        const net::Received received = channel_->receive(deadline);
        deadline = clock_.now();  // after the first message, do not wait
        if (const auto* nothing = std::get_if<net::NoMessage>(&received)) {
            if (*nothing != net::NoMessage::Closed) break;
            fail(Error(ErrorCode::Unavailable, "the connection to the master was closed"));
            return false;
        }
        receive(std::get<net::Message>(received), deadline);
        if (stop.stop_requested()) return false;
    }
    std::vector<net::Bytes> to_send;
    std::vector<wire::BlobRequest> to_ask;
    {
        const std::scoped_lock lock(mutex_);
        if (failure_) return false;
        if (state_ == State::Joined) {  // otherwise keep them queued
            to_send.swap(to_send_);
            to_ask.swap(to_ask_);
        }
    }
    for (net::Bytes& encoded : to_send) outbox_.push_back({net::Link::Control, std::move(encoded)});
    for (const wire::BlobRequest& request : to_ask)
        outbox_.push_back({net::Link::Bulk, wire::encode(wire::BulkMessage(request))});
    watch(clock_.now());
    flush();
    return true;
}

void Link::receive(const net::Message& message, TimePoint now) {
    liveness_.on_message(now);
    last_heard_ = now;
    lost_since_ = now;
    // Malformed messages count as lost; calls that wait for them have deadlines.
    if (message.link == net::Link::Control) {
        if (auto decoded = wire::decode_control(message.bytes)) control(std::move(*decoded), now);
        return;
    }
    auto decoded = wire::decode_bulk(message.bytes);
    if (!decoded) return;
    if (const auto* request = std::get_if<wire::BlobRequest>(&*decoded)) serve(*request);
    if (auto* tile = std::get_if<wire::FrameTile>(&*decoded)) deliver(std::move(*tile));
    if (auto* block = std::get_if<wire::FilmBlock>(&*decoded)) deliver(std::move(*block));
    if (auto* chunk = std::get_if<wire::PictureChunk>(&*decoded)) deliver(std::move(*chunk));
    if (auto* frame = std::get_if<wire::FrameHeader>(&*decoded)) deliver(std::move(*frame));
    if (auto* picture = std::get_if<wire::OutputPicture>(&*decoded)) deliver(std::move(*picture));
    if (auto* blob = std::get_if<wire::BlobChunk>(&*decoded)) deliver(std::move(*blob));
    if (const auto* absent = std::get_if<wire::BlobAbsent>(&*decoded)) deliver(*absent);
}

void Link::control(wire::ControlMessage&& message, TimePoint now) {
    if (const auto* greeting = std::get_if<wire::Welcome>(&message)) return welcome(*greeting, now);
    if (const auto* beat = std::get_if<wire::Heartbeat>(&message)) {
        master_sent_at_ = beat->sent_at;
        master_heard_at_ = now;
        return;
    }
    if (std::holds_alternative<wire::Unknown>(message)) {
        if (state_ != State::Away && now - last_greeting_ >= settings_.heartbeat) greet(now);
        return;
    }
    if (auto* goodbye = std::get_if<wire::Goodbye>(&message)) {
        goodbye_ = std::move(goodbye->reason);
        return enter_away(now);
    }
    if (const auto* refusal = std::get_if<wire::Refusal>(&message); refusal && number_ == 0) {
        return fail(Error(ErrorCode::Refused, "the master refuses: " + refusal->reason));
    }
    deliver(std::move(message));
}

void Link::welcome(const wire::Welcome& welcome, TimePoint now) {
    const bool first = number_ == 0;
    // A restarted master may assign the same number by chance.
    const bool same = welcome.peer_number == number_ && welcome.token == token_;
    const bool repeated = same && state_ == State::Joined;
    number_ = welcome.peer_number;
    token_ = welcome.token;
    state_ = State::Joined;
    is_away_ = false;
    goodbye_.reset();
    const Duration interval = std::clamp<Duration>(welcome.heartbeat_interval, std::chrono::milliseconds(10),
                                                   std::chrono::minutes(1));
    settings_.heartbeat = interval;
    liveness_ = net::Liveness(liveness_settings(interval, std::max(1u, welcome.missed_heartbeats)), now);
    heartbeat_ = interval;
    beat(now);
    if (first) {
        const std::scoped_lock lock(mutex_);
        joined_ = number_;
        changed_.notify_all();
    } else if (!repeated) {
        deliver(Rejoined{.same_session = same});
    }
}

void Link::serve(const wire::BlobRequest& request) {
    if (outbox_.size() >= MaxWaitingMessages) return;
    outbox_.push_back({net::Link::Bulk, wire::encode(wire::answer(request, *blobs_))});
    ++served_;
}

void Link::greet(TimePoint now) {
    state_ = State::Greeting;
    last_greeting_ = now;
    push(wire::Hello{.peer = wire::PeerKind::Client,
                     .name = settings_.name,
                     .host = settings_.host,
                     .software = settings_.software,
                     .pid = settings_.pid,
                     .resume_token = token_});
}

// The token is sent on the bulk link with every heartbeat, in case an earlier one was lost.
void Link::beat(TimePoint now) {
    wire::Heartbeat heartbeat{.sent_at = now.time_since_epoch().count()};
    if (master_sent_at_ != 0) {
        heartbeat.echo_sent_at = master_sent_at_;
        heartbeat.echo_delay = (now - master_heard_at_).count();
    }
    push(heartbeat);
    outbox_.push_back({net::Link::Bulk, wire::encode(wire::BulkMessage(wire::BulkHello{token_}))});
    liveness_.sent_heartbeat(now);
}

void Link::watch(TimePoint now) {
    const bool never_joined = number_ == 0;
    if (state_ != State::Joined &&
        now - lost_since_ >= (never_joined ? settings_.connect_limit : settings_.lost_limit)) {
        return fail(Error(ErrorCode::Unavailable,
                          goodbye_ ? "the master left and did not come back: " + *goodbye_
                          : never_joined
                              ? "the master does not answer: is it running there, and is this key in "
                                "its allow-list?"
                              : "the master does not respond any more: is it still running?"));
    }
    if (state_ == State::Away) {
        if (now < return_at_) return;
        if (reconnect_) reconnect_();
        liveness_.restarted(now);
        return greet(now);
    }
    if (liveness_.timed_out(now)) {
        enter_away(now);
    } else if (state_ == State::Joined && liveness_.heartbeat_due(now)) {
        beat(now);
    }
}

void Link::enter_away(TimePoint now) {
    outbox_.clear();  // belongs to the old sockets
    // A computer that slept has been silent for long, but begins to search only now.
    if (state_ == State::Joined) lost_since_ = now;
    state_ = State::Away;
    if (number_ != 0 && !is_away_.exchange(true)) deliver(Interrupted{});
    return_at_ = now + liveness_.next_backoff();
}

void Link::push(const wire::ControlMessage& message) {
    outbox_.push_back({net::Link::Control, wire::encode(message)});
}

void Link::flush() {
    bool blocked[2] = {false, false};
    for (auto next = outbox_.begin(); next != outbox_.end();) {
        bool& is_blocked = blocked[static_cast<std::size_t>(next->link)];
        const bool gone =
            !is_blocked && channel_->send(next->link, net::ServerPeer, std::move(next->bytes)) !=
                               net::SendResult::WouldBlock;
        if (gone) {
            next = outbox_.erase(next);
        } else {
            is_blocked = true;
            ++next;
        }
    }
}

TimePoint Link::next_wake(TimePoint now) const {
    TimePoint next = now + settings_.heartbeat / 4;
    if (state_ == State::Joined) next = liveness_.next_event();
    if (state_ == State::Away) next = return_at_;
    if (!outbox_.empty()) next = std::min(next, now + std::chrono::milliseconds(2));
    return next;
}

void Link::deliver(Incoming incoming) {
    const std::scoped_lock lock(mutex_);
    inbox_.push_back(std::move(incoming));
    changed_.notify_all();
}

void Link::fail(Error error) {
    const std::scoped_lock lock(mutex_);
    if (!failure_) failure_ = std::move(error);
    changed_.notify_all();
}

}  // namespace tessera::client

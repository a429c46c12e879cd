#include "mediator/net/fault_plan.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include "mediator/base/random.h"

namespace tessera::net {

namespace {

constexpr std::size_t MaxWaiting = 4096;  // messages of one pipe
constexpr Duration BlockedPause = std::chrono::milliseconds(1);
constexpr Duration ReorderSpan = std::chrono::milliseconds(1);

// Messages of one peer on one link in one direction, on their way through the trouble.
class FaultyPipe {
  public:
    FaultyPipe(const FaultPlan& plan, std::uint64_t stream) : plan_(plan), random_(plan.seed, stream) {}

    void enter(Message message, TimePoint now) {
        const bool lost = random_.uniform() < plan_.lose;
        const bool twice = random_.uniform() < plan_.duplicate;
        if (lost) return;
        if (twice) delay(message, now);
        delay(std::move(message), now);
    }

    // The first message whose time has come, until it is popped.
    Message* due(TimePoint now) {
        if (waiting_.empty() || waiting_.begin()->first > now) return nullptr;
        return &waiting_.begin()->second;
    }
    void pop() {
        waiting_.erase(waiting_.begin());
        blocked_until_.reset();
    }
    void block(TimePoint until) { blocked_until_ = until; }
    bool full() const { return blocked_until_.has_value() || waiting_.size() >= MaxWaiting; }
    std::optional<TimePoint> next_due() const {
        if (waiting_.empty()) return std::nullopt;
        return blocked_until_.value_or(waiting_.begin()->first);
    }

  private:
    void delay(Message message, TimePoint now) {
        const Duration waits = plan_.min_delay + part_of(plan_.max_delay - plan_.min_delay);
        if (random_.uniform() < plan_.reorder) {
            // Held back without holding up those behind it.
            const Duration held = part_of(std::max(plan_.max_delay, ReorderSpan));
            waiting_.emplace(now + waits + held, std::move(message));
        } else {
            in_order_ = std::max(in_order_, now + waits);  // nobody overtakes
            waiting_.emplace(in_order_, std::move(message));
        }
    }
    Duration part_of(Duration span) {
        return Duration(static_cast<std::int64_t>(random_.uniform() * static_cast<double>(span.count())));
    }

    FaultPlan plan_;
    CounterRandom random_;
    TimePoint in_order_;
    std::multimap<TimePoint, Message> waiting_;  // equal times leave as they came
    std::optional<TimePoint> blocked_until_;
};

class FaultyChannel final : public Channel {
  public:
    FaultyChannel(std::unique_ptr<Channel> inner, const FaultPlan& control, const FaultPlan& bulk)
        : inner_(std::move(inner)), links_{FaultyLink{.plan = control}, FaultyLink{.plan = bulk}} {}

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (closed_ || bytes.size() > (link == Link::Control ? ControlLimit : BulkLimit)) {
            return SendResult::Closed;
        }
        FaultyLink& faulty = links_[static_cast<std::size_t>(link)];
        const auto out = pipe(faulty.out, peer, faulty.plan, 2 * peer);
        if (!flush(out->second)) {
            faulty.out.erase(out);
            return SendResult::Closed;
        }
        if (out->second.full()) return SendResult::WouldBlock;
        if (cut(faulty)) return SendResult::Sent;
        out->second.enter({.link = link, .peer = peer, .bytes = std::move(bytes)}, now());
        if (flush(out->second)) return SendResult::Sent;
        faulty.out.erase(out);
        return SendResult::Closed;
    }

    Received receive(TimePoint deadline) override {
        while (true) {
            flush_all();
            if (auto message = arrived()) return std::move(*message);
            Received received = inner_->receive(std::min(deadline, next_due().value_or(deadline)));
            if (auto* message = std::get_if<Message>(&received)) {
                FaultyLink& faulty = links_[static_cast<std::size_t>(message->link)];
                if (cut(faulty)) continue;
                const auto in = pipe(faulty.in, message->peer, faulty.plan, 2 * message->peer + 1);
                in->second.enter(std::move(*message), now());
                continue;
            }
            if (std::get<NoMessage>(received) != NoMessage::Timeout || now() >= deadline) return received;
        }
    }

    void wake() override { inner_->wake(); }
    void close() override {
        closed_ = true;
        inner_->close();
    }

  private:
    using Pipes = std::map<PeerId, FaultyPipe>;
    struct FaultyLink {
        FaultPlan plan;
        std::uint64_t messages = 0;  // of both directions
        Pipes out = {}, in = {};
    };

    static TimePoint now() { return std::chrono::steady_clock::now(); }

    static Pipes::iterator pipe(Pipes& pipes, PeerId peer, const FaultPlan& plan, std::uint64_t stream) {
        return pipes.try_emplace(peer, plan, stream).first;
    }

    // One more message for the link; true when it is dead, and with it whatever was under way.
    static bool cut(FaultyLink& faulty) {
        if (faulty.plan.cut_after_messages == 0 || ++faulty.messages <= faulty.plan.cut_after_messages) {
            return false;
        }
        faulty.in.clear();
        faulty.out.clear();
        return true;
    }

    std::optional<Message> arrived() {
        for (FaultyLink& faulty : links_) {
            for (auto& [peer, in] : faulty.in) {
                Message* due = in.due(now());
                if (due == nullptr) continue;
                Message message = std::move(*due);
                in.pop();
                return message;
            }
        }
        return std::nullopt;
    }

    std::optional<TimePoint> next_due() const {
        std::optional<TimePoint> next;
        for (const FaultyLink& faulty : links_) {
            for (const Pipes* pipes : {&faulty.in, &faulty.out}) {
                for (const auto& [peer, waiting] : *pipes) {
                    const auto due = waiting.next_due();
                    if (due && (!next || *due < *next)) next = due;
                }
            }
        }
        return next;
    }

    // False when the peer is gone.
    bool flush(FaultyPipe& out) {
        while (Message* due = out.due(now())) {
            const SendResult result = inner_->send(due->link, due->peer, std::move(due->bytes));
            if (result == SendResult::Closed) return false;
            if (result == SendResult::WouldBlock) {
                out.block(now() + BlockedPause);
                return true;
            }
            out.pop();
        }
        return true;
    }

    void flush_all() {
        for (FaultyLink& faulty : links_) {
            for (auto out = faulty.out.begin(); out != faulty.out.end();) {
                out = flush(out->second) ? std::next(out) : faulty.out.erase(out);
            }
        }
    }

    std::unique_ptr<Channel> inner_;
    std::array<FaultyLink, 2> links_;
    bool closed_ = false;
};

}  // namespace

std::unique_ptr<Channel> with_faults(std::unique_ptr<Channel> inner, const FaultPlan& control,
                                     const FaultPlan& bulk) {
    return std::make_unique<FaultyChannel>(std::move(inner), control, bulk);
}

}  // namespace tessera::net

#include "mediator/net/fault_plan.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "mediator/base/random.h"

namespace tessera::net {

namespace {

constexpr std::size_t MaxWaiting = 4096;  // messages of one pipe
constexpr Duration BlockedPause = std::chrono::milliseconds(1);
constexpr Duration ReorderSpan = std::chrono::milliseconds(1);

// Messages of one peer on one link in one direction, on their way through the fault injection.
class FaultyPipe {
  public:
    FaultyPipe(const FaultPlan& plan, std::uint64_t stream) : plan_(plan), random_(plan.seed, stream) {}

    void enter(Message message, TimePoint now) {
        const std::vector<Passage> passages = std::move(fate().passages);
        taken();
        for (const Passage& passage : passages) {
            TimePoint due = now + passage.waits;
            // Delayed without delaying later messages (reorder), or so that order is kept.
            if (!passage.reordered) due = in_order_ = std::max(in_order_, due);
            waiting_.emplace(due, message);
        }
    }

    // Whether the next message passes unchanged. If so, the caller sends it directly and calls taken().
    bool passes_at_once() {
        return waiting_.empty() && fate().passages.size() == 1 && fate().passages[0].waits.count() == 0;
    }
    void taken() { fate_.reset(); }

    // The first message that is due, until it is popped.
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
    struct Passage {
        Duration waits{0};
        bool reordered = false;
    };
    struct Fate {
        std::vector<Passage> passages;  // none: lost
    };

    // Faults of the next message: drawn once, however often sending is retried.
    Fate& fate() {
        if (fate_) return *fate_;
        fate_.emplace();
        const bool lost = random_.uniform() < plan_.lose;
        const bool twice = random_.uniform() < plan_.duplicate;
        for (int i = 0; i < (lost ? 0 : twice ? 2 : 1); ++i) {
            Passage passage{plan_.min_delay + part_of(plan_.max_delay - plan_.min_delay),
                            random_.uniform() < plan_.reorder};
            if (passage.reordered) passage.waits += part_of(std::max(plan_.max_delay, ReorderSpan));
            fate_->passages.push_back(passage);
        }
        return *fate_;
    }
    Duration part_of(Duration span) {
        return Duration(static_cast<std::int64_t>(random_.uniform() * static_cast<double>(span.count())));
    }

    FaultPlan plan_;
    CounterRandom random_;
    std::optional<Fate> fate_;
    TimePoint in_order_;
    std::multimap<TimePoint, Message> waiting_;  // equal times keep their order
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
        if (is_cut(faulty)) return SendResult::Sent;
        const auto out = pipe(faulty.out, peer, faulty.plan, stream(link, Outward, peer));
        const SendResult result = send_through(out->second, {link, peer, Role::None, {}, {}}, bytes);
        if (result == SendResult::Sent) ++faulty.messages;
        if (result == SendResult::Closed) faulty.out.erase(out);
        return result;
    }

    Received receive(TimePoint deadline) override {
        while (true) {
            flush_all();
            if (auto message = arrived()) return std::move(*message);
            Received received = inner_->receive(std::min(deadline, next_due().value_or(deadline)));
            if (auto* message = std::get_if<Message>(&received)) {
                FaultyLink& faulty = links_[static_cast<std::size_t>(message->link)];
                if (is_cut(faulty)) continue;
                ++faulty.messages;
                const auto in =
                    pipe(faulty.in, message->peer, faulty.plan, stream(message->link, Inward, message->peer));
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

    // Every pipe has its own random stream.
    enum Direction : std::uint64_t { Outward, Inward };
    static std::uint64_t stream(Link link, Direction direction, PeerId peer) {
        return 4 * peer + 2 * direction + static_cast<std::uint64_t>(link);
    }

    static Pipes::iterator pipe(Pipes& pipes, PeerId peer, const FaultPlan& plan, std::uint64_t stream) {
        return pipes.try_emplace(peer, plan, stream).first;
    }

    // Then whatever was under way is lost, too.
    static bool is_cut(FaultyLink& faulty) {
        if (faulty.plan.cut_after_messages == 0 || faulty.messages < faulty.plan.cut_after_messages) {
            return false;
        }
        faulty.in.clear();
        faulty.out.clear();
        return true;
    }

    SendResult send_through(FaultyPipe& out, Message message, Bytes& bytes) {
        if (!flush(out)) return SendResult::Closed;
        if (out.full()) return SendResult::WouldBlock;
        if (out.passes_at_once()) {
            const SendResult result = inner_->send(message.link, message.peer, std::move(bytes));
            if (result == SendResult::Sent) out.taken();
            return result;
        }
        message.bytes = std::move(bytes);
        out.enter(std::move(message), now());
        return flush(out) ? SendResult::Sent : SendResult::Closed;
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

    // False if the peer is gone.
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

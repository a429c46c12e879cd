#include "mediator/net/fault_plan.h"

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "mediator/base/random.h"

namespace tessera::net {

namespace {

// Messages of one link in one direction, on their way through the trouble.
class FaultyPipe {
  public:
    FaultyPipe(const FaultPlan& plan, std::uint64_t stream) : plan_(plan), random_(plan.seed, stream) {}

    void enter(Message message, TimePoint now) {
        if (plan_.cut_after_messages != 0 && ++entered_ > plan_.cut_after_messages) return;
        if (random_.uniform() < plan_.lose) return;
        const bool twice = random_.uniform() < plan_.duplicate;
        if (twice) delay(message, now);
        delay(std::move(message), now);
    }

    std::optional<Message> leave(TimePoint now) {
        if (waiting_.empty() || waiting_.front().due > now) return std::nullopt;
        Message message = std::move(waiting_.front().message);
        waiting_.erase(waiting_.begin());
        return message;
    }
    void put_back(Message message) { waiting_.insert(waiting_.begin(), {TimePoint{}, std::move(message)}); }
    std::optional<TimePoint> next_due() const {
        if (waiting_.empty()) return std::nullopt;
        return waiting_.front().due;
    }

  private:
    struct Waiting {
        TimePoint due;
        Message message;
    };

    void delay(Message message, TimePoint now) {
        const auto spread = static_cast<std::uint64_t>((plan_.max_delay - plan_.min_delay).count());
        TimePoint due = now + plan_.min_delay +
                        Duration(spread == 0 ? 0 : static_cast<std::int64_t>(random_.below(spread)));
        auto place = waiting_.end();
        if (random_.uniform() < plan_.reorder) {
            // Somewhere among those that wait, at once if nobody does.
            place = waiting_.begin() + static_cast<std::ptrdiff_t>(random_.below(waiting_.size() + 1));
        } else if (!waiting_.empty()) {
            due = std::max(due, waiting_.back().due);  // order is kept: nobody overtakes
        }
        if (place != waiting_.end()) due = std::min(due, place->due);
        waiting_.insert(place, {due, std::move(message)});
    }

    FaultPlan plan_;
    CounterRandom random_;
    std::uint64_t entered_ = 0;
    std::vector<Waiting> waiting_;  // in the order of leaving
};

class FaultyChannel final : public Channel {
  public:
    FaultyChannel(std::unique_ptr<Channel> inner, const FaultPlan& control, const FaultPlan& bulk)
        : inner_(std::move(inner)),
          out_{FaultyPipe(control, 1), FaultyPipe(bulk, 2)},
          in_{FaultyPipe(control, 3), FaultyPipe(bulk, 4)} {}

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (bytes.size() > (link == Link::Control ? ControlLimit : BulkLimit)) return SendResult::Closed;
        pipe(out_, link).enter({.link = link, .peer = peer, .bytes = std::move(bytes)}, now());
        return flush() ? SendResult::Sent : SendResult::Closed;
    }

    Received receive(TimePoint deadline) override {
        while (true) {
            flush();
            for (FaultyPipe& pipe : in_) {
                if (auto message = pipe.leave(now())) return std::move(*message);
            }
            TimePoint until = deadline;
            for (const auto* pipes : {&in_, &out_}) {
                for (const FaultyPipe& pipe : *pipes)
                    until = std::min(until, pipe.next_due().value_or(until));
            }
            Received received = inner_->receive(until);
            if (auto* message = std::get_if<Message>(&received)) {
                pipe(in_, message->link).enter(std::move(*message), now());
                continue;
            }
            if (std::get<NoMessage>(received) != NoMessage::Timeout || now() >= deadline) return received;
        }
    }

    void wake() override { inner_->wake(); }
    void close() override { inner_->close(); }

  private:
    using Pipes = std::array<FaultyPipe, 2>;
    static FaultyPipe& pipe(Pipes& pipes, Link link) { return pipes[static_cast<std::size_t>(link)]; }
    static TimePoint now() { return std::chrono::steady_clock::now(); }

    // False when a peer is gone.
    bool flush() {
        bool reachable = true;
        for (FaultyPipe& pipe : out_) {
            while (auto message = pipe.leave(now())) {
                const SendResult result =
                    inner_->send(message->link, message->peer, std::move(message->bytes));
                reachable = reachable && result != SendResult::Closed;
                if (result != SendResult::WouldBlock) continue;
                pipe.put_back(std::move(*message));
                break;
            }
        }
        return reachable;
    }

    std::unique_ptr<Channel> inner_;
    Pipes out_, in_;
};

}  // namespace

std::unique_ptr<Channel> with_faults(std::unique_ptr<Channel> inner, const FaultPlan& control,
                                     const FaultPlan& bulk) {
    return std::make_unique<FaultyChannel>(std::move(inner), control, bulk);
}

}  // namespace tessera::net

#include "tests/cluster/link_switch.h"

#include <algorithm>
#include <deque>
#include <mutex>

namespace tessera::test {

class LinkSwitch::Switched final : public net::Channel {
  public:
    Switched(LinkSwitch& state, const Open& open) : state_(state), open_(open), inner_(open()) {}

    net::SendResult send(net::Link link, net::PeerId peer, net::Bytes&& bytes) override {
        if (state_.is_cut_) {
            bytes.clear();
            return net::SendResult::Sent;
        }
        send_held();
        if (link == net::Link::Control || (!state_.stalls_ && outgoing_.empty()))
            return inner()->send(link, peer, std::move(bytes));
        if (outgoing_.size() >= QueueLimit) return net::SendResult::WouldBlock;
        outgoing_.push_back(std::move(bytes));
        return net::SendResult::Sent;
    }
    net::Received receive(TimePoint deadline) override {
        constexpr Duration Step = std::chrono::milliseconds(20);
        while (true) {
            send_held();
            if (!state_.stalls_ && !incoming_.empty()) {
                net::Received first = std::move(incoming_.front());
                incoming_.pop_front();
                return first;
            }
            net::Received received = inner()->receive(std::min(deadline, SteadyClock().now() + Step));
            const auto* message = std::get_if<net::Message>(&received);
            if (message == nullptr) {
                if (std::get<net::NoMessage>(received) != net::NoMessage::Timeout ||
                    SteadyClock().now() >= deadline)
                    return received;
            } else if (!state_.is_cut_) {
                if (message->link == net::Link::Control || (!state_.stalls_ && incoming_.empty()))
                    return received;
                incoming_.push_back(std::move(received));
            }
        }
    }
    void wake() override { inner()->wake(); }
    void close() override { inner()->close(); }

    void reopen() {
        outgoing_.clear();
        incoming_.clear();
        std::shared_ptr<net::Channel> fresh = open_();
        const std::scoped_lock lock(mutex_);
        inner_->close();
        inner_ = std::move(fresh);
    }

  private:
    static constexpr std::size_t QueueLimit = 64;

    std::shared_ptr<net::Channel> inner() const {
        const std::scoped_lock lock(mutex_);
        return inner_;
    }
    void send_held() {
        while (!state_.stalls_ && !state_.is_cut_ && !outgoing_.empty()) {
            if (inner()->send(net::Link::Bulk, net::ServerPeer, std::move(outgoing_.front())) ==
                net::SendResult::WouldBlock)
                return;
            outgoing_.pop_front();
        }
    }

    LinkSwitch& state_;
    Open open_;
    mutable std::mutex mutex_;  // protects the pointer
    std::shared_ptr<net::Channel> inner_;
    std::deque<net::Bytes> outgoing_;
    std::deque<net::Received> incoming_;
};

std::unique_ptr<net::Channel> LinkSwitch::channel(const Open& open) {
    auto made = std::make_unique<Switched>(*this, open);
    channel_ = made.get();
    return made;
}

void LinkSwitch::reconnect() {
    is_cut_ = false;
    channel_->reopen();
}

}  // namespace tessera::test

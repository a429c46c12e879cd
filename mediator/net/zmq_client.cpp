#include "mediator/net/zmq_channel.h"
#include "mediator/net/zmq_context.h"
#include "mediator/net/zmq_link.h"

namespace tessera::net {

namespace {

class DealerPair final : public ZmqClient {
  public:
    DealerPair(std::shared_ptr<ZmqContext> context, const ClientSettings& settings)
        : context_(std::move(context)), addresses_(addresses_of(settings.endpoint)), keys_(settings.keys) {
        require_keys(settings.endpoint, addresses_, keys_ ? Keys::Present : Keys::Absent);
        open();
    }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (closed_ || peer != ServerPeer || bytes.size() > limit_of(link)) return SendResult::Closed;
        return send_message(socket(link), nullptr, bytes);
    }

    Received receive(TimePoint deadline) override {
        while (!closed_) {
            if (signal_.take()) return NoMessage::Woken;
            for (int i = 0; i < 2; ++i) {
                const Link link = turn_ == Link::Control ? Link::Bulk : Link::Control;
                turn_ = link;
                if (auto message = take(link)) return std::move(*message);
            }
            if (std::chrono::steady_clock::now() >= deadline) return NoMessage::Timeout;
            wait_readable(sockets_, signal_, deadline);
        }
        return NoMessage::Closed;
    }

    void wake() override { signal_.raise(); }

    void close() override {
        closed_ = true;
        for (zmq::socket_t& socket : sockets_) socket.close();
    }

    void reconnect() override {
        if (closed_) return;
        for (zmq::socket_t& socket : sockets_) {
            // Messages not sent on the old connection are void on the new one.
            socket.set(zmq::sockopt::linger, 0);
            socket.close();
        }
        open();
    }

  private:
    zmq::socket_t& socket(Link link) { return sockets_[static_cast<std::size_t>(link)]; }

    void open() {
        for (const Link link : {Link::Control, Link::Bulk}) {
            socket(link) = zmq::socket_t(context_->zmq(), zmq::socket_type::dealer);
            configure(socket(link), link, addresses_);
            if (keys_ && addresses_.is_tcp) {
                socket(link).set(zmq::sockopt::curve_serverkey, keys_->server_public_key);
                socket(link).set(zmq::sockopt::curve_publickey, keys_->own.public_key);
                socket(link).set(zmq::sockopt::curve_secretkey, keys_->own.secret_key);
            }
            const std::string& address = link == Link::Control ? addresses_.control : addresses_.bulk;
            try {
                socket(link).connect(address);
            } catch (const zmq::error_t& error) {
                throw Error(ErrorCode::InvalidInput, "cannot connect to " + address + ": " + error.what());
            }
        }
    }

    std::optional<Message> take(Link link) {
        Parts<1> parts;
        while (receive_message(socket(link), parts)) {
            const zmq::message_t& payload = parts.kept[0];
            if (parts.count != 1 || payload.size() > limit_of(link)) continue;
            const auto* data = payload.data<std::byte>();
            // All messages are from the master: the handshake has checked its key.
            return Message{.link = link, .role = Role::Operator, .bytes = Bytes(data, data + payload.size())};
        }
        return std::nullopt;
    }

    std::shared_ptr<ZmqContext> context_;
    Addresses addresses_;
    std::optional<ClientKeys> keys_;
    std::array<zmq::socket_t, 2> sockets_;  // by link
    Link turn_ = Link::Bulk;
    WakeSignal signal_;
    bool closed_ = false;
};

}  // namespace

std::unique_ptr<ZmqClient> make_zmq_client(std::shared_ptr<ZmqContext> context,
                                           const ClientSettings& settings) {
    return std::make_unique<DealerPair>(std::move(context), settings);
}

}  // namespace tessera::net

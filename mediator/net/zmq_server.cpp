#include "mediator/net/peer_table.h"
#include "mediator/net/zmq_channel.h"
#include "mediator/net/zmq_context.h"
#include "mediator/net/zmq_link.h"

namespace tessera::net {

namespace {

constexpr int EnforceDomain = 93;  // ZMQ_ZAP_ENFORCE_DOMAIN: in Debian's library, not in its stable header
constexpr std::size_t MaxPeers = 8192;

class RouterPair final : public ZmqServer {
  public:
    RouterPair(std::shared_ptr<ZmqContext> context, const ServerSettings& settings)
        : context_(std::move(context)),
          keys_(settings.keys),
          sockets_{zmq::socket_t(context_->zmq(), zmq::socket_type::router),
                   zmq::socket_t(context_->zmq(), zmq::socket_type::router)} {
        const Addresses addresses = addresses_of(settings.endpoint);
        require_keys(settings.endpoint, addresses, keys_ ? Keys::Present : Keys::Absent);
        encrypted_ = keys_.has_value() && addresses.is_tcp;
        for (const Link link : {Link::Control, Link::Bulk}) configure(socket(link), link, addresses);
        if (encrypted_) secure();
        bind(Link::Control, addresses.control);
        bind(Link::Bulk, addresses.bulk);
    }

    ~RouterPair() override {
        if (encrypted_) context_->zap().forget(domain_);
    }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        if (closed_ || bytes.size() > limit_of(link)) return SendResult::Closed;
        const PeerTable::Peer* known = peers(link).find(peer);
        if (known == nullptr) return SendResult::Closed;
        SendResult result = SendResult::Closed;
        if (is_allowed(known->user_id)) result = send_message(socket(link), &known->routing_id, bytes);
        if (result == SendResult::Closed) peers(link).forget(peer);
        return result;
    }

    Received receive(TimePoint deadline) override {
        while (!closed_) {
            if (signal_.take()) return NoMessage::Woken;
            // Alternates between the links, so that neither starves.
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

    void reload_keys() override {
        if (encrypted_) context_->zap().allow(domain_, keys_->allowed());
    }

    std::uint64_t refused_handshakes() const override {
        return encrypted_ ? context_->zap().refused(domain_) : 0;
    }
    Dropped dropped() const override { return dropped_; }

  private:
    zmq::socket_t& socket(Link link) { return sockets_[static_cast<std::size_t>(link)]; }
    PeerTable& peers(Link link) { return peers_[static_cast<std::size_t>(link)]; }

    void secure() {
        const KeyPair master = keys_->master();
        domain_ = context_->new_domain();
        context_->zap().allow(domain_, keys_->allowed());
        for (zmq::socket_t& socket : sockets_) {
            socket.set(zmq::sockopt::curve_server, true);
            socket.set(zmq::sockopt::curve_publickey, master.public_key);
            socket.set(zmq::sockopt::curve_secretkey, master.secret_key);
            socket.set(zmq::sockopt::zap_domain, domain_);
            const int on = 1;
            if (zmq_setsockopt(socket.handle(), EnforceDomain, &on, sizeof on) != 0) {
                throw Error(ErrorCode::Internal,
                            "libzmq does not know ZMQ_ZAP_ENFORCE_DOMAIN: it would let any key in");
            }
        }
    }

    void bind(Link link, const std::string& address) {
        try {
            socket(link).bind(address);
        } catch (const zmq::error_t& error) {
            throw Error(ErrorCode::Unavailable, "cannot listen on " + address + ": " + error.what() +
                                                    "; choose another port with --listen");
        }
    }

    bool is_allowed(const std::string& user_id) const {
        return !encrypted_ || context_->zap().is_allowed(domain_, user_id);
    }

    // Nothing if there is none. Anything but one routing id and one part is dropped and counted.
    std::optional<Message> take(Link link) {
        Parts<2> parts;
        constexpr int MaxDropped = 256;  // a revoked key that goes on sending delays no one
        for (int i = 0; i < MaxDropped && receive_message(socket(link), parts); ++i) {
            const zmq::message_t& payload = parts.kept[1];
            if (parts.count != 2 || payload.size() > limit_of(link)) {
                ++dropped_.malformed;
                continue;
            }
            Message message{.link = link, .role = Role::Operator};
            std::string id;
            if (encrypted_) {
                id = metadata(parts.kept[1], "User-Id");
                if (!is_allowed(id)) {
                    ++dropped_.revoked;
                    continue;
                }
                const User user = user_of(id);
                message.role = user.role;
                message.user = user.name;
            }
            message.peer = peers(link).number(parts.kept[0].to_string(), id, next_peer_);
            const auto* data = payload.data<std::byte>();
            message.bytes.assign(data, data + payload.size());
            return message;
        }
        return std::nullopt;
    }

    static std::string metadata(zmq::message_t& message, const char* property) {
        const char* value = zmq_msg_gets(message.handle(), property);
        return value == nullptr ? std::string() : value;
    }

    std::shared_ptr<ZmqContext> context_;
    std::optional<KeyDirectory> keys_;
    bool encrypted_ = false;
    std::string domain_;
    std::array<zmq::socket_t, 2> sockets_;  // by link
    std::array<PeerTable, 2> peers_{PeerTable(MaxPeers), PeerTable(MaxPeers)};
    PeerId next_peer_ = 1;
    Dropped dropped_;
    Link turn_ = Link::Bulk;
    WakeSignal signal_;
    bool closed_ = false;
};

}  // namespace

std::shared_ptr<ZmqContext> make_zmq_context(int io_threads) {
    return std::make_shared<ZmqContext>(io_threads);
}

ZapHandler& ZmqContext::zap() {
    const std::scoped_lock lock(mutex_);
    if (!zap_) zap_.emplace(context_);
    return *zap_;
}

std::unique_ptr<ZmqServer> make_zmq_server(std::shared_ptr<ZmqContext> context,
                                           const ServerSettings& settings) {
    return std::make_unique<RouterPair>(std::move(context), settings);
}

}  // namespace tessera::net

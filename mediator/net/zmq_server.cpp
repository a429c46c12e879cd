#include <algorithm>
#include <map>
#include <unordered_map>

#include "mediator/net/zmq_channel.h"
#include "mediator/net/zmq_context.h"
#include "mediator/net/zmq_link.h"

namespace tessera::net {

namespace {

constexpr int EnforceDomain = 93;  // ZMQ_ZAP_ENFORCE_DOMAIN: in Debian's library, not in its stable header
constexpr std::size_t MaxPeers = 8192;

// The remote ends of one link, numbered as they first speak.
class Peers {
  public:
    PeerId number(const std::string& routing_id, PeerId& next) {
        const auto [place, fresh] = numbers_.try_emplace(routing_id, next);
        if (fresh) {
            routing_ids_.emplace(next++, routing_id);
            // The oldest go first: whoever of them still lives gets a new number and has to say hello again.
            if (routing_ids_.size() > MaxPeers) forget(routing_ids_.begin()->first);
        }
        return place->second;
    }
    const std::string* routing_id(PeerId peer) const {
        const auto place = routing_ids_.find(peer);
        return place == routing_ids_.end() ? nullptr : &place->second;
    }
    void forget(PeerId peer) {
        const auto place = routing_ids_.find(peer);
        if (place == routing_ids_.end()) return;
        numbers_.erase(place->second);
        routing_ids_.erase(place);
    }

  private:
    std::unordered_map<std::string, PeerId> numbers_;
    std::map<PeerId, std::string> routing_ids_;
};

class RouterPair final : public ZmqServer {
  public:
    RouterPair(std::shared_ptr<ZmqContext> context, const ServerSettings& settings)
        : context_(std::move(context)),
          keys_(settings.keys),
          sockets_{zmq::socket_t(context_->zmq(), zmq::socket_type::router),
                   zmq::socket_t(context_->zmq(), zmq::socket_type::router)} {
        const Addresses addresses = addresses_of(settings.endpoint);
        if (addresses.is_tcp && !addresses.is_loopback && !keys_) {
            throw Error(ErrorCode::Refused, "'" + settings.endpoint +
                                                "' can be reached from other machines: give --keys (made by "
                                                "'tessera keys'), or listen on 127.0.0.1");
        }
        encrypted_ = keys_.has_value() && addresses.is_tcp;
        for (const Link link : {Link::Control, Link::Bulk}) configure(socket(link), link);
        if (encrypted_) secure();
        bind(Link::Control, addresses.control);
        bind(Link::Bulk, addresses.bulk);
    }

    ~RouterPair() override {
        if (encrypted_) context_->zap().forget(domain_);
    }

    SendResult send(Link link, PeerId peer, Bytes&& bytes) override {
        const std::string* routing_id = peers(link).routing_id(peer);
        if (closed_ || routing_id == nullptr || bytes.size() > limit_of(link)) return SendResult::Closed;
        try {
            const auto flags = zmq::send_flags::sndmore | zmq::send_flags::dontwait;
            if (!socket(link).send(zmq::buffer(*routing_id), flags)) return SendResult::WouldBlock;
            // After the routing id was taken, its payload is too.
            socket(link).send(zmq::buffer(bytes), zmq::send_flags::dontwait);
            return SendResult::Sent;
        } catch (const zmq::error_t& error) {
            if (error.num() != EHOSTUNREACH)
                throw Error(ErrorCode::Internal, std::string("send: ") + error.what());
            peers(link).forget(peer);
            return SendResult::Closed;
        }
    }

    Received receive(TimePoint deadline) override {
        while (!closed_) {
            // Turns between the links, so that neither starves.
            for (int i = 0; i < 2; ++i) {
                const Link link = turn_ == Link::Control ? Link::Bulk : Link::Control;
                turn_ = link;
                if (auto message = take(link)) return std::move(*message);
            }
            if (signal_.take()) return NoMessage::Woken;
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

    std::uint64_t refused_handshakes() const override { return encrypted_ ? context_->zap().refused() : 0; }

  private:
    zmq::socket_t& socket(Link link) { return sockets_[static_cast<std::size_t>(link)]; }
    Peers& peers(Link link) { return peers_[static_cast<std::size_t>(link)]; }

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

    // Nothing when none is there. What is not one routing id and one part is dropped and counted.
    std::optional<Message> take(Link link) {
        zmq::message_t routing_id;
        while (socket(link).recv(routing_id, zmq::recv_flags::dontwait)) {
            zmq::message_t payload;
            int parts = 0;
            while (socket(link).get(zmq::sockopt::rcvmore)) {
                if (!socket(link).recv(payload, zmq::recv_flags::dontwait)) break;
                ++parts;
            }
            if (parts != 1 || payload.size() > limit_of(link)) continue;
            Message message{.link = link, .role = Role::Operator};
            if (encrypted_) {
                const std::string id = metadata(payload, "User-Id");
                if (!context_->zap().stands(domain_, id)) continue;  // revoked: unread
                const User user = user_of(id);
                message.role = user.role;
                message.user = user.name;
            }
            message.peer = peers(link).number(routing_id.to_string(), next_peer_);
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
    std::array<Peers, 2> peers_;
    PeerId next_peer_ = 1;
    Link turn_ = Link::Bulk;
    WakeSignal signal_;
    bool closed_ = false;
};

}  // namespace

std::shared_ptr<ZmqContext> make_zmq_context() {
    return std::make_shared<ZmqContext>();
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

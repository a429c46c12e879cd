#include "tests/client/scripted_master.h"

#include <algorithm>

namespace tessera::client {

namespace {

constexpr std::chrono::seconds Patience(20);

TimePoint now() {
    return SteadyClock().now();
}

}  // namespace

net::Message ScriptedMaster::next(net::Link link) {
    const auto kept =
        std::find_if(kept_.begin(), kept_.end(), [&](const auto& message) { return message.link == link; });
    if (kept != kept_.end()) {
        net::Message message = std::move(*kept);
        kept_.erase(kept);
        return message;
    }
    const TimePoint deadline = now() + Patience;
    while (now() < deadline) {
        net::Received received = channel_->receive(deadline);
        auto* message = std::get_if<net::Message>(&received);
        if (message == nullptr) continue;
        (message->link == net::Link::Control ? control_ : bulk_) = message->peer;
        if (message->link == link) return std::move(*message);
        kept_.push_back(std::move(*message));
    }
    throw std::runtime_error("the client sent nothing");
}

wire::ControlMessage ScriptedMaster::next_control(Heartbeats heartbeats) {
    while (true) {
        auto decoded = wire::decode_control(next(net::Link::Control).bytes);
        if (!decoded) throw decoded.error();
        if (heartbeats == Heartbeats::Take || !std::holds_alternative<wire::Heartbeat>(*decoded))
            return *decoded;
    }
}

wire::BulkMessage ScriptedMaster::next_bulk() {
    while (true) {
        auto decoded = wire::decode_bulk(next(net::Link::Bulk).bytes);
        if (!decoded) throw decoded.error();
        const bool is_token = std::holds_alternative<wire::BulkHello>(*decoded);
        if (!is_token || !std::exchange(bulk_is_open_, true)) return *decoded;
    }
}

int ScriptedMaster::count_heartbeats(Duration during) {
    int count = 0;
    for (const TimePoint end = now() + during; now() < end;) {
        count += std::holds_alternative<wire::Heartbeat>(next_control(Heartbeats::Take)) ? 1 : 0;
    }
    return count;
}

void ScriptedMaster::send(const wire::ControlMessage& message) {
    send_raw(net::Link::Control, wire::encode(message));
}

void ScriptedMaster::send(const wire::BulkMessage& message) {
    send_raw(net::Link::Bulk, wire::encode(message));
}

void ScriptedMaster::send_raw(net::Link link, net::Bytes bytes) {
    const net::PeerId peer = (link == net::Link::Control ? control_ : bulk_).value();
    if (channel_->send(link, peer, std::move(bytes)) != net::SendResult::Sent)
        throw std::runtime_error("not sent");
}

wire::Hello ScriptedMaster::greet(const wire::Welcome& welcome) {
    bulk_is_open_ = false;
    const auto hello = expect<wire::Hello>();
    send(welcome);
    while (expect_bulk<wire::BulkHello>().token != welcome.token) bulk_is_open_ = false;
    return hello;
}

}  // namespace tessera::client

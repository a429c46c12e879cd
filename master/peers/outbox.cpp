#include "master/peers/outbox.h"

#include "mediator/wire/envelope.h"

namespace tessera::master {

void Outbox::control(net::PeerId peer, const wire::ControlMessage& message) {
    control(peer, wire::encode(message));
}

void Outbox::control(net::PeerId peer, net::Bytes&& encoded) {
    if (!wire::fits_control(encoded)) {  // its receiver would end the connection
        throw Error(ErrorCode::Internal, "a control message of " + std::to_string(encoded.size()) +
                                             " bytes is longer than peers accept: it was not sent");
    }
    bytes.control += encoded.size();
    put(net::Link::Control, peer, std::move(encoded));
}

void Outbox::bulk(net::PeerId peer, const wire::BulkMessage& message) {
    const bool is_film = std::holds_alternative<wire::FrameTile>(message) ||
                         std::holds_alternative<wire::PictureChunk>(message);
    bulk(peer, wire::encode(message), is_film ? &session::WireBytes::film : &session::WireBytes::blobs);
}

void Outbox::bulk(net::PeerId peer, net::Bytes&& encoded, std::uint64_t session::WireBytes::*counter) {
    bytes.*counter += encoded.size();
    put(net::Link::Bulk, peer, std::move(encoded));
}

void Outbox::put(net::Link link, net::PeerId peer, net::Bytes&& message) {
    const auto queue = queues_.find({link, peer});
    if (queue == queues_.end()) {
        switch (channel_.send(link, peer, std::move(message))) {
            case net::SendResult::Sent:
                return;
            case net::SendResult::Closed:
                lost_.emplace_back(link, peer);
                return;
            case net::SendResult::WouldBlock:
                break;
        }
    }
    // NOLINTBEGIN(bugprone-use-after-move): a send that would block takes nothing
    Queue& waiting = queues_[{link, peer}];
    waiting.bytes += message.size();
    waiting.messages.push_back(std::move(message));
    // NOLINTEND(bugprone-use-after-move)
    if (waiting.bytes > OutboxLimit) {
        lost_.emplace_back(link, peer);
        queues_.erase({link, peer});
    }
}

void Outbox::flush() {
    for (auto entry = queues_.begin(); entry != queues_.end();) {
        const auto [link, peer] = entry->first;
        Queue& queue = entry->second;
        bool gone = false;
        while (!queue.messages.empty()) {
            const std::size_t size = queue.messages.front().size();
            const net::SendResult result = channel_.send(link, peer, std::move(queue.messages.front()));
            if (result == net::SendResult::WouldBlock) break;
            gone = result == net::SendResult::Closed;
            if (gone) break;
            queue.bytes -= size;
            queue.messages.pop_front();
        }
        if (gone) lost_.emplace_back(link, peer);
        entry = gone || queue.messages.empty() ? queues_.erase(entry) : std::next(entry);
    }
}

std::size_t Outbox::waiting_bytes(net::Link link, net::PeerId peer) const {
    const auto queue = queues_.find({link, peer});
    return queue == queues_.end() ? 0 : queue->second.bytes;
}

std::size_t Outbox::waiting_bytes() const {
    std::size_t bytes = 0;
    for (const auto& [key, queue] : queues_) bytes += queue.bytes;
    return bytes;
}

}  // namespace tessera::master

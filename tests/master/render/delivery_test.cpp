// Pictures on their way to clients.
#include "master/render/delivery.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "mediator/wire/envelope.h"

namespace tessera::master {
namespace {

// Takes so many bulk messages, and counts what is in them.
class SlowChannel final : public net::Channel {
  public:
    net::SendResult send(net::Link link, net::PeerId, net::Bytes&& bytes) override {
        if (link != net::Link::Bulk) return net::SendResult::Sent;
        if (room == 0) return net::SendResult::WouldBlock;
        --room;
        const auto message = wire::decode_bulk(bytes);
        if (!message) return net::SendResult::Closed;
        if (const auto* chunk = std::get_if<wire::PictureChunk>(&*message)) {
            is_in_order = is_in_order && chunk->offset == picture_bytes;
            picture_bytes += chunk->data.size();
        }
        return net::SendResult::Sent;
    }
    net::Received receive(TimePoint) override { return net::NoMessage::Timeout; }
    void wake() override {}
    void close() override {}

    std::size_t room = std::numeric_limits<std::size_t>::max();
    std::uint64_t picture_bytes = 0;
    bool is_in_order = true;
};

// 8K float planes have 398 MB.
TEST(Delivery, APictureLargerThanTheSendQueueIsSentAsTheLinkDrains) {
    SlowChannel channel;
    RenderOutputs outputs(channel);
    FilmStore film(outputs);
    ViewIds ids;
    ViewTable views(ids);
    SessionTable sessions;
    Outbox outbox(channel);
    Delivery delivery(views, sessions, outbox, film);
    const SessionRecord& session = sessions.add({.id = SessionId{1},
                                                 .control = 1,
                                                 .bulk = 2,
                                                 .user = "ann",
                                                 .hello = {},
                                                 .liveness = net::Liveness({}, TimePoint{}),
                                                 .fetcher = wire::BlobFetcher(nullptr, {}),
                                                 .edits = {}});
    const auto picture = std::make_shared<const std::vector<std::byte>>(OutboxLimit + 12345);
    delivery.send_kept(session, {.view = {}, .header = {}, .summary = {}, .picture = picture});
    channel.room = 3;
    std::size_t most = 0;
    for (int turn = 0; turn < 10000 && channel.picture_bytes < picture->size(); ++turn) {
        delivery.send();
        most = std::max(most, outbox.waiting_bytes(net::Link::Bulk, 2));
        channel.room += 3;
        outbox.flush();
    }
    EXPECT_EQ(channel.picture_bytes, picture->size());
    EXPECT_TRUE(channel.is_in_order);
    EXPECT_LE(most, OutboxLimit / 4);
    EXPECT_TRUE(outbox.take_lost().empty()) << "its watcher was removed";
    EXPECT_EQ(delivery.in_flight(session.id), 0u);
}

}  // namespace
}  // namespace tessera::master

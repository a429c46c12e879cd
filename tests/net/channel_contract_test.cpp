// The contract of every channel (mediator/net/channel.h), tested for each transport.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "mediator/net/fault_plan.h"
#include "mediator/net/loopback.h"
#include "tests/net/net_support.h"

namespace tessera::net {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// One server and a factory of its clients.
struct Rig {
    std::unique_ptr<Channel> server;
    std::function<std::unique_ptr<Channel>()> client;
};

Rig loopback() {
    const auto hub = std::make_shared<LoopbackHub>();
    return {hub->server(), [hub] { return hub->client(Role::Operator); }};
}

Rig inproc() {
    const auto context = make_zmq_context();
    const std::string endpoint = "inproc://contract";
    return {make_zmq_server(context, {.endpoint = endpoint, .keys = {}}),
            [=] { return make_zmq_client(context, {.endpoint = endpoint, .keys = {}}); }};
}

Rig tcp() {
    const auto context = make_zmq_context();
    TcpServer server = make_tcp_server(context);
    return {std::move(server.channel), [context, endpoint = server.endpoint] {
                return make_zmq_client(context, {.endpoint = endpoint, .keys = {}});
            }};
}

Rig curve() {
    const auto folder = std::make_shared<TemporaryFolder>();
    const KeyDirectory keys(*folder / "keys");
    keys.create();
    const auto context = make_zmq_context();
    TcpServer server = make_tcp_server(context, keys);
    return {std::move(server.channel), [folder, keys, context, endpoint = server.endpoint] {
                return make_zmq_client(context, {.endpoint = endpoint, .keys = keys.client("operator")});
            }};
}

// The fault injection without faults.
Rig harmless_faults(const std::function<Rig()>& make) {
    Rig rig = make();
    rig.server = with_faults(std::move(rig.server), {}, {});
    rig.client = [inner = rig.client] { return with_faults(inner(), {}, {}); };
    return rig;
}

struct Transport {
    const char* name;
    std::function<Rig()> make;
};

class ChannelContract : public testing::TestWithParam<Transport> {
  protected:
    void SetUp() override {
        rig_ = GetParam().make();
        client_ = rig_.client();
    }
    Channel& server() { return *rig_.server; }
    Channel& client() { return *client_; }

    // The server's number for this client's link.
    PeerId meet(Channel& from, Link link) {
        EXPECT_EQ(send_patiently(from, link, ServerPeer, numbered(0)), SendResult::Sent);
        const auto message = next_message(server());
        EXPECT_TRUE(message.has_value());
        return message ? message->peer : 0;
    }

    Rig rig_;
    std::unique_ptr<Channel> client_;
};

std::size_t limit_of_link(Link link) {
    return link == Link::Control ? ControlLimit : BulkLimit;
}

// Sends until the queue is full; returns the number of accepted messages.
std::uint64_t fill(Channel& channel, Link link, PeerId peer, std::size_t size) {
    for (std::uint64_t sent = 0; sent < 1'000'000; ++sent) {
        Bytes bytes = numbered(sent, size);
        const SendResult result = channel.send(link, peer, std::move(bytes));
        if (result == SendResult::Sent) continue;
        EXPECT_EQ(result, SendResult::WouldBlock);
        EXPECT_EQ(bytes, numbered(sent, size)) << "a refused message was taken";
        return sent;
    }
    ADD_FAILURE() << "the queue is unbounded";
    return 0;
}

void expect_numbers(Channel& channel, Link link, std::uint64_t count) {
    for (std::uint64_t expected = 0; expected < count; ++expected) {
        const auto message = next_message(channel);
        ASSERT_TRUE(message.has_value()) << "lost message " << expected;
        ASSERT_EQ(message->link, link);
        ASSERT_EQ(number_of(message->bytes), expected);
    }
}

TEST_P(ChannelContract, KeepsOrderWithinEachLinkBothWays) {
    constexpr std::uint64_t Count = 300;
    const PeerId control = meet(client(), Link::Control), bulk = meet(client(), Link::Bulk);
    std::thread sender([&] {
        for (std::uint64_t i = 0; i < Count; ++i) {
            send_patiently(client(), Link::Control, ServerPeer, numbered(i));
            send_patiently(client(), Link::Bulk, ServerPeer, numbered(i, 2000));
        }
    });
    std::array<std::uint64_t, 2> next{0, 0};
    for (std::uint64_t i = 0; i < 2 * Count; ++i) {
        const auto message = next_message(server());
        if (!message) break;
        EXPECT_EQ(number_of(message->bytes), next[static_cast<std::size_t>(message->link)]++);
        EXPECT_EQ(message->peer, message->link == Link::Control ? control : bulk);
    }
    sender.join();
    ASSERT_EQ(next, (std::array<std::uint64_t, 2>{Count, Count}));

    for (std::uint64_t i = 0; i < Count; ++i) {
        ASSERT_EQ(send_patiently(server(), Link::Control, control, numbered(i)), SendResult::Sent);
    }
    expect_numbers(client(), Link::Control, Count);
}

TEST_P(ChannelContract, ClientsFullQueueBlocksAndLosesNothing) {
    meet(client(), Link::Control);
    const std::uint64_t sent = fill(client(), Link::Control, ServerPeer, 8192);
    EXPECT_GT(sent, 0u);
    expect_numbers(server(), Link::Control, sent);
    EXPECT_EQ(send_patiently(client(), Link::Control, ServerPeer, numbered(7)), SendResult::Sent);
    EXPECT_TRUE(next_message(server()).has_value());
}

TEST_P(ChannelContract, ServersFullQueueBlocksAndLosesNothing) {
    const PeerId peer = meet(client(), Link::Bulk);
    const auto other = rig_.client();
    const PeerId reading = meet(*other, Link::Bulk);
    const std::uint64_t sent = fill(server(), Link::Bulk, peer, 65536);
    EXPECT_GT(sent, 0u);
    EXPECT_EQ(server().send(Link::Bulk, reading, numbered(1)), SendResult::Sent)
        << "a full peer must not block another";
    EXPECT_TRUE(next_message(*other).has_value());
    expect_numbers(client(), Link::Bulk, sent);
}

TEST_P(ChannelContract, UnknownPeersAreClosed) {
    const PeerId control = meet(client(), Link::Control);
    EXPECT_EQ(server().send(Link::Control, control + 1000, numbered(1)), SendResult::Closed);
    EXPECT_EQ(server().send(Link::Bulk, control, numbered(1)), SendResult::Closed) << "of the other link";
    EXPECT_EQ(server().send(Link::Control, ServerPeer, numbered(1)), SendResult::Closed);
    EXPECT_EQ(client().send(Link::Control, control, numbered(1)), SendResult::Closed);
}

TEST_P(ChannelContract, PeersThatLeftAreClosed) {
    const PeerId peer = meet(client(), Link::Control);
    client_.reset();
    EXPECT_TRUE(
        eventually([&] { return server().send(Link::Control, peer, numbered(1)) == SendResult::Closed; }));
}

TEST_P(ChannelContract, EachClientGetsItsOwnAnswers) {
    const auto other = rig_.client();
    const PeerId first = meet(client(), Link::Control), second = meet(*other, Link::Control);
    ASSERT_NE(first, second);
    EXPECT_EQ(server().send(Link::Control, second, numbered(2)), SendResult::Sent);
    EXPECT_EQ(server().send(Link::Control, first, numbered(1)), SendResult::Sent);
    EXPECT_EQ(number_of(next_message(client())->bytes), 1u);
    EXPECT_EQ(number_of(next_message(*other)->bytes), 2u);
    EXPECT_FALSE(next_message(client(), milliseconds(20)).has_value());
}

TEST_P(ChannelContract, WakesFromAnotherThread) {
    for (Channel* channel : {&server(), &client()}) {
        std::thread other([channel] {
            std::this_thread::sleep_for(milliseconds(20));
            channel->wake();
        });
        const Received received = channel->receive(in(seconds(30)));
        other.join();
        ASSERT_TRUE(std::holds_alternative<NoMessage>(received));
        EXPECT_EQ(std::get<NoMessage>(received), NoMessage::Woken);
        EXPECT_EQ(std::get<NoMessage>(channel->receive(in(milliseconds(1)))), NoMessage::Timeout);
    }
}

TEST_P(ChannelContract, AnEarlierWakeEndsTheNextReceiveEvenWhenMessagesWait) {
    meet(client(), Link::Control);
    ASSERT_EQ(client().send(Link::Control, ServerPeer, numbered(5)), SendResult::Sent);
    ASSERT_EQ(client().send(Link::Control, ServerPeer, numbered(6)), SendResult::Sent);
    ASSERT_EQ(number_of(next_message(server())->bytes), 5u);
    server().wake();
    server().wake();
    const Received received = server().receive(in(seconds(30)));
    ASSERT_TRUE(std::holds_alternative<NoMessage>(received));
    EXPECT_EQ(std::get<NoMessage>(received), NoMessage::Woken);
    EXPECT_EQ(number_of(next_message(server())->bytes), 6u);
}

TEST_P(ChannelContract, ManyWakesAreNeverLostForGood) {
    std::atomic<int> posted = 0;
    std::atomic<bool> seen_all = false;
    constexpr int Count = 2000;
    std::thread other([&] {
        for (int i = 0; i < Count; ++i) {
            ++posted;
            server().wake();
        }
    });
    while (!seen_all) {
        const Received received = server().receive(in(seconds(30)));
        ASSERT_EQ(std::get<NoMessage>(received), NoMessage::Woken);
        seen_all = posted == Count;
    }
    other.join();
}

TEST_P(ChannelContract, TimesOutNotBeforeTheDeadline) {
    const TimePoint deadline = in(milliseconds(30));
    EXPECT_EQ(std::get<NoMessage>(client().receive(deadline)), NoMessage::Timeout);
    EXPECT_GE(std::chrono::steady_clock::now(), deadline);
    EXPECT_EQ(std::get<NoMessage>(client().receive(TimePoint::min())), NoMessage::Timeout);
}

TEST_P(ChannelContract, ADeadlineInThePastStillTakesWhatIsThere) {
    const PeerId peer = meet(client(), Link::Control);
    ASSERT_EQ(server().send(Link::Control, peer, numbered(3)), SendResult::Sent);
    EXPECT_TRUE(eventually([&] {
        const Received received = client().receive(TimePoint{});
        return std::holds_alternative<Message>(received);
    }));
}

TEST_P(ChannelContract, CarriesTheLongestMessageAndRefusesALongerOne) {
    for (const Link link : {Link::Control, Link::Bulk}) {
        const PeerId peer = meet(client(), link);
        const std::size_t limit = limit_of_link(link);
        EXPECT_EQ(client().send(link, ServerPeer, Bytes(limit + 1)), SendResult::Closed);
        EXPECT_EQ(server().send(link, peer, Bytes(limit + 1)), SendResult::Closed);
        ASSERT_EQ(client().send(link, ServerPeer, numbered(8, limit)), SendResult::Sent);
        const auto message = next_message(server());
        ASSERT_TRUE(message.has_value());
        EXPECT_EQ(message->bytes, numbered(8, limit));
        EXPECT_EQ(server().send(link, peer, numbered(9)), SendResult::Sent) << "the peer is still there";
        EXPECT_EQ(number_of(next_message(client())->bytes), 9u);
    }
}

TEST_P(ChannelContract, CarriesEmptyMessages) {
    ASSERT_EQ(client().send(Link::Control, ServerPeer, Bytes{}), SendResult::Sent);
    const auto message = next_message(server());
    ASSERT_TRUE(message.has_value());
    EXPECT_TRUE(message->bytes.empty());
}

TEST_P(ChannelContract, ClosedStaysClosed) {
    const PeerId peer = meet(client(), Link::Control);
    for (int i = 0; i < 2; ++i) {
        server().close();
        client().close();
    }
    EXPECT_EQ(server().send(Link::Control, peer, numbered(1)), SendResult::Closed);
    EXPECT_EQ(client().send(Link::Control, ServerPeer, numbered(1)), SendResult::Closed);
    EXPECT_EQ(std::get<NoMessage>(server().receive(in(seconds(30)))), NoMessage::Closed);
    EXPECT_EQ(std::get<NoMessage>(client().receive(in(seconds(30)))), NoMessage::Closed);
    server().wake();
    EXPECT_EQ(std::get<NoMessage>(server().receive(in(seconds(30)))), NoMessage::Closed);
}

TEST_P(ChannelContract, ReportsTheRoleOfThePeer) {
    ASSERT_EQ(client().send(Link::Bulk, ServerPeer, numbered(1)), SendResult::Sent);
    EXPECT_EQ(next_message(server())->role, Role::Operator);
}

INSTANTIATE_TEST_SUITE_P(
    Every, ChannelContract,
    testing::Values(Transport{"Loopback", loopback}, Transport{"Inproc", inproc}, Transport{"Tcp", tcp},
                    Transport{"Curve", curve},
                    Transport{"FaultsAroundLoopback", [] { return harmless_faults(loopback); }},
                    Transport{"FaultsAroundTcp", [] { return harmless_faults(tcp); }}),
    [](const testing::TestParamInfo<Transport>& transport) { return std::string(transport.param.name); });

}  // namespace

}  // namespace tessera::net

// Specific to the ZeroMQ channel: addresses, misbehaving peers, reconnection, bounds.
#include "mediator/net/zmq_channel.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <thread>
#include <zmq.hpp>

#include "mediator/net/zmq_link.h"
#include "tests/net/net_support.h"

namespace tessera::net {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

template <class Call>
ErrorCode code_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.code();
    }
    ADD_FAILURE() << "nothing was thrown";
    return ErrorCode::Internal;
}

// A peer that sends arbitrary multi-part messages.
struct RawDealer {
    explicit RawDealer(const std::string& endpoint) : socket(context, zmq::socket_type::dealer) {
        socket.set(zmq::sockopt::linger, 0);
        socket.connect(endpoint);
    }
    void send(std::size_t size, zmq::send_flags flags = zmq::send_flags::none) {
        socket.send(zmq::message_t(size), flags);
    }
    zmq::context_t context;
    zmq::socket_t socket;
};

TEST(ZmqAddresses, AreValidatedAndLoopbackIsDetected) {
    EXPECT_EQ(addresses_of("tcp://127.0.0.1:7420").bulk, "tcp://127.0.0.1:7421");
    EXPECT_EQ(addresses_of("inproc://a").bulk, "inproc://a.bulk");
    for (const char* loopback :
         {"tcp://127.0.0.1:1", "tcp://127.9.9.9:1", "tcp://localhost:1", "tcp://[::1]:1"}) {
        EXPECT_TRUE(addresses_of(loopback).is_loopback) << loopback;
    }
    for (const char* open : {"tcp://*:1", "tcp://0.0.0.0:1", "tcp://127.evil.example:1", "tcp://[::]:1",
                             "tcp://10.0.0.1:1", "tcp://[::ffff:10.0.0.1]:1"}) {
        EXPECT_FALSE(addresses_of(open).is_loopback) << open;
    }
    for (const char* bad :
         {"", "tcp://", "tcp://host", "tcp://host:", "tcp://:1", "tcp://h:0", "tcp://h:65535",
          "tcp://h:99999999999", "tcp://h:1x", "tcp://h:-1", "udp://h:1", "inproc://", "h:1"}) {
        EXPECT_EQ(code_of([&] { addresses_of(bad); }), ErrorCode::InvalidInput) << bad;
    }
}

// The thread that raises it is interrupted between its flag, which was taken, and its descriptor.
TEST(WakeSignal, DoesNotSpinWhenOnlyItsDescriptorIsReadable) {
    zmq::context_t context;
    std::array<zmq::socket_t, 2> sockets{zmq::socket_t(context, zmq::socket_type::dealer),
                                         zmq::socket_t(context, zmq::socket_type::dealer)};
    WakeSignal signal;
    const std::uint64_t one = 1;
    ASSERT_EQ(::write(signal.descriptor(), &one, sizeof one), static_cast<ssize_t>(sizeof one));
    wait_readable(sockets, signal, std::chrono::steady_clock::now() + std::chrono::seconds(60));
    EXPECT_FALSE(signal.take());
    const TimePoint before = std::chrono::steady_clock::now();
    wait_readable(sockets, signal, before + std::chrono::milliseconds(50));
    EXPECT_GE(std::chrono::steady_clock::now() - before, std::chrono::milliseconds(50))
        << "it is not readable";
    signal.raise();
    wait_readable(sockets, signal, std::chrono::steady_clock::now() + std::chrono::seconds(60));
    EXPECT_TRUE(signal.take());
    EXPECT_FALSE(signal.take());
}

TEST(ZmqChannel, RefusesTheNetworkWithoutKeys) {
    const auto context = make_zmq_context();
    for (const char* endpoint :
         {"tcp://0.0.0.0:7420", "tcp://*:7420", "tcp://10.1.2.3:7420", "tcp://[::]:7420"}) {
        EXPECT_EQ(code_of([&] { make_zmq_server(context, {.endpoint = endpoint, .keys = {}}); }),
                  ErrorCode::Refused);
        EXPECT_EQ(code_of([&] { make_zmq_client(context, {.endpoint = endpoint, .keys = {}}); }),
                  ErrorCode::Refused);
    }
}

TEST(ZmqChannel, ATakenPortIsUnavailable) {
    const auto context = make_zmq_context();
    const TcpServer server = make_tcp_server(context);
    EXPECT_EQ(code_of([&] { make_zmq_server(context, {.endpoint = server.endpoint, .keys = {}}); }),
              ErrorCode::Unavailable);
    EXPECT_EQ(code_of([&] { make_zmq_server(context, {.endpoint = server.bulk_endpoint, .keys = {}}); }),
              ErrorCode::Unavailable);
}

TEST(ZmqChannel, ServesIpv6) {
    const auto context = make_zmq_context();
    const std::string port = make_tcp_server(context).endpoint.substr(sizeof("tcp://127.0.0.1"));
    const std::string endpoint = "tcp://[::1]:" + port;
    std::unique_ptr<ZmqServer> server;
    try {
        server = make_zmq_server(context, {.endpoint = endpoint, .keys = {}});
    } catch (const Error&) {
        GTEST_SKIP() << "this machine has no IPv6";
    }
    const auto client = make_zmq_client(context, {.endpoint = endpoint, .keys = {}});
    ASSERT_EQ(client->send(Link::Bulk, ServerPeer, numbered(6)), SendResult::Sent);
    EXPECT_TRUE(next_message(*server).has_value());
}

TEST(ZmqChannel, DropsAndCountsMessagesOfManyParts) {
    TcpServer server = make_tcp_server(make_zmq_context());
    RawDealer dealer(server.endpoint);
    for (int i = 0; i < 3; ++i) {
        dealer.send(4, zmq::send_flags::sndmore);
        dealer.send(5);
    }
    dealer.send(6);
    const auto message = next_message(*server.channel);
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(message->bytes.size(), 6u);
    EXPECT_EQ(server.channel->dropped().malformed, 3u);
}

TEST(ZmqChannel, NeverDeliversAnOversizeMessageAndKeepsServingOthers) {
    TcpServer server = make_tcp_server(make_zmq_context());
    RawDealer oversized(server.endpoint), slightly(server.endpoint), good(server.endpoint);
    oversized.send(50 << 20);
    slightly.send(ControlLimit + 1);  // what encryption may add: libzmq lets it through, we do not
    good.send(7);
    const auto message = next_message(*server.channel);
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(message->bytes.size(), 7u);
    EXPECT_FALSE(next_message(*server.channel, milliseconds(100)).has_value());
    EXPECT_EQ(server.channel->dropped().malformed, 1u);
}

TEST(ZmqChannel, SurvivesInvalidZmtp) {
    TcpServer server = make_tcp_server(make_zmq_context());
    zmq::context_t context;
    zmq::socket_t stream(context, zmq::socket_type::stream);
    stream.set(zmq::sockopt::linger, 0);
    stream.connect(server.endpoint);
    const std::string id = stream.get(zmq::sockopt::routing_id);
    for (int i = 0; i < 20; ++i) {
        stream.send(zmq::buffer(id), zmq::send_flags::sndmore);
        stream.send(zmq::buffer(std::string("GET / HTTP/1.1\r\n\r\n")), zmq::send_flags::dontwait);
    }
    RawDealer good(server.endpoint);
    good.send(3);
    EXPECT_TRUE(next_message(*server.channel).has_value());
}

TEST(ZmqChannel, ReconnectsToANewServerAtTheSameAddress) {
    const auto context = make_zmq_context();
    TcpServer server = make_tcp_server(context);
    const auto client = make_zmq_client(context, {.endpoint = server.endpoint, .keys = {}});
    ASSERT_EQ(client->send(Link::Control, ServerPeer, numbered(1)), SendResult::Sent);
    ASSERT_TRUE(next_message(*server.channel).has_value());
    server.channel.reset();
    ASSERT_TRUE(eventually([&] {
        try {
            server.channel = make_zmq_server(context, {.endpoint = server.endpoint, .keys = {}});
        } catch (const Error&) {
            return false;
        }
        return true;
    }));
    client->reconnect();
    ASSERT_EQ(client->send(Link::Control, ServerPeer, numbered(2)), SendResult::Sent);
    const auto message = next_message(*server.channel);
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(number_of(message->bytes), 2u);
    EXPECT_EQ(send_patiently(*server.channel, Link::Control, message->peer, numbered(3)), SendResult::Sent);
    EXPECT_TRUE(next_message(*client).has_value());
}

// The memory that a peer can use on a server that does not read: two queues and the kernel's buffers.
TEST(ZmqChannel, AFloodIsBoundedByTheByteBudget) {
    TcpServer server = make_tcp_server(make_zmq_context());
    const auto client = make_zmq_client(make_zmq_context(), {.endpoint = server.endpoint, .keys = {}});
    for (const Link link : {Link::Control, Link::Bulk}) {
        std::size_t accepted = 0;
        const auto flood = [&] {
            Bytes bytes(limit_of(link));
            if (client->send(link, ServerPeer, std::move(bytes)) != SendResult::Sent) return false;
            accepted += limit_of(link);
            return accepted <= 4 * QueueBudget;
        };
        while (eventually(flood, milliseconds(100)) && accepted <= 4 * QueueBudget) {
        }
        EXPECT_GT(accepted, QueueBudget / 2);
        EXPECT_LE(accepted, 2 * QueueBudget + QueueBudget / 2);
    }
    EXPECT_TRUE(next_message(*server.channel).has_value()) << "and it is served again";
}

TEST(ZmqChannel, ManyClientsComeAndGo) {
    const auto context = make_zmq_context();
    TcpServer server = make_tcp_server(context);
    for (int i = 0; i < 100; ++i) {
        const auto client = make_zmq_client(context, {.endpoint = server.endpoint, .keys = {}});
        ASSERT_EQ(client->send(Link::Control, ServerPeer, numbered(static_cast<std::uint64_t>(i))),
                  SendResult::Sent);
        const auto message = next_message(*server.channel);
        ASSERT_TRUE(message.has_value());
        ASSERT_EQ(number_of(message->bytes), static_cast<std::uint64_t>(i));
    }
}

}  // namespace

}  // namespace tessera::net

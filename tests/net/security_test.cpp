// Authentication: CURVE keys, the allow-list, roles, and the libzmq behaviour they rely on.
#include <gtest/gtest.h>

#include <array>
#include <thread>
#include <zmq.hpp>

#include "mediator/net/zap.h"
#include "tests/net/net_support.h"

namespace tessera::net {

namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
constexpr int EnforceDomain = 93;

// Whether a CURVE server of libzmq without a ZAP handler accepts unknown keys.
enum class Enforcement { Off, On };
enum class Mechanism { Null, Curve };
bool accepts_stranger(const std::string& domain, Enforcement enforcement, Mechanism mechanism) {
    zmq::context_t context;
    zmq::socket_t server(context, zmq::socket_type::router), client(context, zmq::socket_type::dealer);
    const KeyPair master = make_key_pair(), stranger = make_key_pair();
    server.set(zmq::sockopt::linger, 0);
    client.set(zmq::sockopt::linger, 0);
    server.set(zmq::sockopt::rcvtimeo, 500);
    server.set(zmq::sockopt::curve_server, true);
    server.set(zmq::sockopt::curve_secretkey, master.secret_key);
    if (!domain.empty()) server.set(zmq::sockopt::zap_domain, domain);
    if (enforcement == Enforcement::On) {
        const int on = 1;
        EXPECT_EQ(zmq_setsockopt(server.handle(), EnforceDomain, &on, sizeof on), 0);
    }
    server.bind("tcp://127.0.0.1:*");
    if (mechanism == Mechanism::Curve) {
        client.set(zmq::sockopt::curve_serverkey, master.public_key);
        client.set(zmq::sockopt::curve_publickey, stranger.public_key);
        client.set(zmq::sockopt::curve_secretkey, stranger.secret_key);
    }
    client.connect(server.get(zmq::sockopt::last_endpoint));
    client.send(zmq::str_buffer("hello"));
    zmq::message_t message;
    return server.recv(message).has_value();
}

TEST(ZapTruthTable, OnlyADomainWithEnforcementRefusesWithoutAHandler) {
    EXPECT_TRUE(accepts_stranger("", Enforcement::Off, Mechanism::Curve));
    EXPECT_TRUE(accepts_stranger("tessera", Enforcement::Off, Mechanism::Curve));
    EXPECT_TRUE(accepts_stranger("", Enforcement::On, Mechanism::Curve));
    EXPECT_FALSE(accepts_stranger("tessera", Enforcement::On, Mechanism::Curve));
}

TEST(ZapTruthTable, ACurveServerRefusesAClientWithoutCurve) {
    EXPECT_FALSE(accepts_stranger("", Enforcement::Off, Mechanism::Null));
    EXPECT_FALSE(accepts_stranger("tessera", Enforcement::On, Mechanism::Null));
}

class Security : public testing::Test {
  protected:
    Security() : keys_(folder_ / "keys") {
        keys_.create();
        server_ = make_tcp_server(context_, keys_);
    }

    std::unique_ptr<ZmqClient> client(const ClientKeys& keys) {
        return make_zmq_client(make_zmq_context(), {.endpoint = server_.endpoint, .keys = keys});
    }
    ClientKeys added(const std::string& name, Role role) {
        keys_.add(name, role, folder_ / (name + ".key"));
        server_.channel->reload_keys();
        return KeyDirectory(folder_ / (name + ".key")).client(name);
    }
    ClientKeys stranger() const { return {make_key_pair(), keys_.client("viewer").server_public_key}; }

    TemporaryFolder folder_;
    KeyDirectory keys_;
    std::shared_ptr<ZmqContext> context_ = make_zmq_context();
    TcpServer server_;
};

TEST_F(Security, TheRoleIsThatOfTheKeyOnBothLinks) {
    for (const Role role : {Role::Viewer, Role::Editor, Role::Node, Role::Operator}) {
        const auto peer = client(keys_.client(name(role)));
        for (const Link link : {Link::Control, Link::Bulk}) {
            ASSERT_EQ(peer->send(link, ServerPeer, numbered(1)), SendResult::Sent);
            const auto message = next_message(*server_.channel);
            ASSERT_TRUE(message.has_value());
            EXPECT_EQ(message->role, role);
            EXPECT_EQ(message->user, name(role));
            EXPECT_EQ(message->link, link);
        }
    }
    EXPECT_EQ(server_.channel->refused_handshakes(), 0u);
}

TEST_F(Security, AnUnknownKeyIsRefusedOnEachSocket) {
    const ClientKeys unknown = stranger();
    std::uint64_t refused = 0;
    for (const std::string& endpoint : {server_.endpoint, server_.bulk_endpoint}) {
        zmq::context_t context;
        zmq::socket_t socket(context, zmq::socket_type::dealer);
        socket.set(zmq::sockopt::linger, 0);
        socket.set(zmq::sockopt::curve_serverkey, unknown.server_public_key);
        socket.set(zmq::sockopt::curve_publickey, unknown.own.public_key);
        socket.set(zmq::sockopt::curve_secretkey, unknown.own.secret_key);
        socket.connect(endpoint);
        socket.send(zmq::str_buffer("let me in"));
        EXPECT_TRUE(eventually([&] { return server_.channel->refused_handshakes() > refused; })) << endpoint;
        refused = server_.channel->refused_handshakes();
        EXPECT_FALSE(next_message(*server_.channel, milliseconds(100)).has_value()) << endpoint;
    }
}

TEST_F(Security, AClientWithoutKeysIsRejectedOnEachSocket) {
    const auto open = make_zmq_client(make_zmq_context(), {.endpoint = server_.endpoint, .keys = {}});
    for (const Link link : {Link::Control, Link::Bulk}) open->send(link, ServerPeer, numbered(1));
    EXPECT_FALSE(next_message(*server_.channel, milliseconds(300)).has_value());
    const auto good = client(keys_.client("node"));
    good->send(Link::Control, ServerPeer, numbered(2));
    const auto message = next_message(*server_.channel);
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(message->user, "node");
}

TEST_F(Security, AMasterWithAnotherKeyReceivesNothing) {
    ClientKeys keys = keys_.client("editor");
    keys.server_public_key = make_key_pair().public_key;
    const auto deceived = client(keys);
    deceived->send(Link::Control, ServerPeer, numbered(1));
    EXPECT_FALSE(next_message(*server_.channel, milliseconds(300)).has_value());
}

TEST_F(Security, AKeyAddedLaterIsAcceptedAfterReload) {
    keys_.add("late", Role::Viewer, folder_ / "late.key");
    const auto late = client(KeyDirectory(folder_ / "late.key").client("whatever"));
    late->send(Link::Control, ServerPeer, numbered(1));
    ASSERT_TRUE(eventually([&] { return server_.channel->refused_handshakes() > 0; }));
    server_.channel->reload_keys();
    late->reconnect();
    late->send(Link::Control, ServerPeer, numbered(2));
    const auto message = next_message(*server_.channel);
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(message->user, "late");
    EXPECT_EQ(message->role, Role::Viewer);
}

TEST_F(Security, ARevokedUserCannotSendReceiveOrReconnect) {
    const auto revoked = client(added("guest", Role::Editor)), other = client(keys_.client("viewer"));
    ASSERT_EQ(revoked->send(Link::Control, ServerPeer, numbered(1)), SendResult::Sent);
    const auto first = next_message(*server_.channel);
    ASSERT_TRUE(first.has_value());
    ASSERT_EQ(server_.channel->send(Link::Control, first->peer, numbered(1)), SendResult::Sent);

    keys_.revoke("guest");
    server_.channel->reload_keys();
    for (std::uint64_t i = 0; i < 3; ++i) {
        ASSERT_EQ(revoked->send(Link::Control, ServerPeer, numbered(i)), SendResult::Sent);
        ASSERT_EQ(revoked->send(Link::Bulk, ServerPeer, numbered(i)), SendResult::Sent);
    }
    EXPECT_TRUE(eventually([&] {
        EXPECT_FALSE(next_message(*server_.channel, milliseconds(5)).has_value());
        return server_.channel->dropped().revoked >= 3;  // its bulk link may not have been there before
    }));
    EXPECT_EQ(server_.channel->send(Link::Control, first->peer, numbered(2)), SendResult::Closed);

    const std::uint64_t refused = server_.channel->refused_handshakes();
    revoked->reconnect();
    revoked->send(Link::Control, ServerPeer, numbered(9));
    EXPECT_TRUE(eventually([&] { return server_.channel->refused_handshakes() > refused; }));
    other->send(Link::Control, ServerPeer, numbered(5));
    const auto heard = next_message(*server_.channel);
    ASSERT_TRUE(heard.has_value());
    EXPECT_EQ(heard->user, "viewer");
}

TEST_F(Security, ReusingANameDoesNotReactivateTheRevokedKey) {
    const auto old = client(added("guest", Role::Operator));
    old->send(Link::Control, ServerPeer, numbered(1));
    ASSERT_TRUE(next_message(*server_.channel).has_value());
    keys_.revoke("guest");
    std::filesystem::remove(folder_ / "guest.key");
    added("guest", Role::Operator);
    old->send(Link::Control, ServerPeer, numbered(2));
    EXPECT_TRUE(eventually([&] {
        EXPECT_FALSE(next_message(*server_.channel, milliseconds(5)).has_value());
        return server_.channel->dropped().revoked == 1;
    }));
}

TEST_F(Security, AnInvalidAllowListKeepsTheOldOne) {
    const auto peer = client(keys_.client("node"));
    peer->send(Link::Control, ServerPeer, numbered(1));
    ASSERT_TRUE(next_message(*server_.channel).has_value());
    std::filesystem::resize_file(folder_ / "keys/allowed.keys", 90);
    EXPECT_THROW(server_.channel->reload_keys(), Error);
    peer->send(Link::Control, ServerPeer, numbered(2));
    EXPECT_TRUE(next_message(*server_.channel).has_value());
}

TEST_F(Security, ServersOfOneContextHaveSeparateLists) {
    const KeyDirectory others(folder_ / "others");
    others.create();
    TcpServer second = make_tcp_server(context_, others);
    // A key of the first, towards the second.
    ClientKeys wrong = keys_.client("operator");
    wrong.server_public_key = others.client("viewer").server_public_key;
    const auto intruder = make_zmq_client(context_, {.endpoint = second.endpoint, .keys = wrong});
    intruder->send(Link::Control, ServerPeer, numbered(1));
    EXPECT_TRUE(eventually([&] { return second.channel->refused_handshakes() > 0; }));
    EXPECT_EQ(server_.channel->refused_handshakes(), 0u);

    const auto good =
        make_zmq_client(context_, {.endpoint = second.endpoint, .keys = others.client("viewer")});
    good->send(Link::Control, ServerPeer, numbered(2));
    const auto message = next_message(*second.channel);
    ASSERT_TRUE(message.has_value());
    EXPECT_EQ(message->role, Role::Viewer);
}

TEST(UserIds, ForgedOnesHaveNoRole) {
    const AllowedKey key{.name = "ann", .role = Role::Node, .public_key = std::string(40, 'k')};
    EXPECT_EQ(user_of(user_id(key)).role, Role::Node);
    EXPECT_EQ(user_of(user_id(key)).name, "ann");
    for (const char* text :
         {"", ":", "::", "node", "node:ann", "root:ann:k", "NODE:ann:k", ":ann:k", "none:ann:k"}) {
        EXPECT_EQ(user_of(text).role, Role::None) << text;
    }
}

}  // namespace

}  // namespace tessera::net

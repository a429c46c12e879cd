// Answers about many nodes, members and locks are longer than a message: they come in pages, or say what they leave out.
#include <gtest/gtest.h>

#include "mediator/scene/fields.h"
#include "tests/cluster/cluster_scene.h"
#include "tests/cluster/loopback_cluster.h"
#include "tests/cluster/raw_peer.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

wire::Hello long_hello(int number) {
    wire::Hello hello{.peer = wire::PeerKind::Node,
                      .name = "node " + std::to_string(number) + std::string(200, 'n'),
                      .host = std::string(200, 'h')};
    hello.backend = "null";
    hello.kind = std::string(200, 'k');
    hello.concurrent_units = 0;
    return hello;
}

TEST(ManyPeers, TheStatusOfFiveHundredNodesArrivesWhole) {
    LoopbackCluster cluster;
    std::vector<RawPeer> peers;
    for (int i = 0; i < 500; ++i) {
        peers.emplace_back(cluster.channel(net::Role::Node));
        peers.back().send(wire::ControlMessage(long_hello(i)));
    }
    const auto session = cluster.session(std::make_shared<scene::BlobStore>());
    session::ClusterStatus status;
    for (int i = 0; i < 200 && status.nodes.size() < 500; ++i) {
        status = session->status();
        std::this_thread::sleep_for(5ms);
    }
    ASSERT_EQ(status.nodes.size(), 500u);
    for (std::size_t i = 0; i < status.nodes.size(); ++i)
        EXPECT_EQ(status.nodes[i].summary.name, long_hello(static_cast<int>(i)).name);
}

TEST(ManyPeers, ANameThatIsTooLongIsNoNode) {
    LoopbackCluster cluster;
    RawPeer peer(cluster.channel(net::Role::Node));
    wire::Hello hello = long_hello(1);
    hello.name.resize(60'000, 'x');
    peer.send(wire::ControlMessage(hello));
    hello = long_hello(2);
    hello.concurrent_units = 2'000'000'000;
    peer.send(wire::ControlMessage(hello));
    const auto session = cluster.session(std::make_shared<scene::BlobStore>());
    for (int i = 0; i < 20; ++i) peer.poll();
    const session::ClusterStatus status = session->status();
    EXPECT_TRUE(status.nodes.empty());
    EXPECT_GE(status.dropped_messages, 2u);
}

TEST(ManyPeers, ThousandsOfLocksAreListedAsFarAsTheyFit) {
    LoopbackCluster cluster;
    auto blobs = std::make_shared<scene::BlobStore>();
    const auto session = cluster.member(std::string(60, 'a'), blobs);
    std::vector<ObjectId> objects;
    std::vector<scene::Entry> entries;
    for (int i = 0; i < 4000; ++i) {
        objects.push_back(session->new_id());
        entries.push_back(scene::Create{objects.back(), scene::Light{}});
    }
    ASSERT_TRUE(session->submit(std::move(entries)).accepted);
    for (std::size_t i = 0; i < objects.size(); i += 1000)
        session->lock({objects.begin() + static_cast<std::ptrdiff_t>(i),
                       objects.begin() + static_cast<std::ptrdiff_t>(i) + 1000});
    const session::Members members = session->members();
    EXPECT_EQ(members.members.size(), 1u);
    EXPECT_GT(members.locks.size(), 100u);
    EXPECT_EQ(members.locks.size() + members.unlisted, 4000u);
    EXPECT_EQ(session->status().caught_exceptions, 0u);
}

}  // namespace
}  // namespace tessera::test

#include "master/scene/scene_distributor.h"

#include <gtest/gtest.h>

#include <condition_variable>
#include <deque>

#include "mediator/net/loopback.h"
#include "mediator/scene/fields.h"
#include "tests/master/scene/authority_fixture.h"

namespace tessera::master {
namespace {

using namespace scene;

struct SceneDistributorTest : AuthorityFixture {
    static constexpr int Objects = 1000;  // more than a short list
    std::mutex mutex;                     // protects made
    std::condition_variable has_made;
    std::deque<EncodedScene> made;
    scene::BlobStore store;
    net::LoopbackHub hub;
    std::unique_ptr<net::Channel> channel = hub.server();
    Outbox outbox{*channel};
    NodeTable nodes{{}, {}};
    SceneEncoder encoder{[this](EncodedScene encoded) {
        const std::scoped_lock lock(mutex);
        made.push_back(std::move(encoded));
        has_made.notify_one();
    }};
    SceneDistributor distributor{authority.published(), encoder, store, outbox, [](const Event&) {}};
    Member ann = join(1, "ann");
    NodeRecord& node = nodes.add(NodeId{1}, 1, 1, "node", wire::Hello{}, TimePoint{});

    EncodedScene next() {
        std::unique_lock lock(mutex);
        has_made.wait(lock, [&] { return !made.empty(); });
        EncodedScene encoded = std::move(made.front());
        made.pop_front();
        return encoded;
    }
    void publish() {
        auto changes = authority.publish();
        ASSERT_TRUE(changes);
        distributor.published(nodes, std::make_shared<const ChangeList>(std::move(*changes)), TimePoint{});
    }
    void create_all() {
        std::vector<Entry> entries;
        for (int i = 0; i < Objects; ++i) entries.push_back(Create{id(i), Material{.name = "m"}});
        ASSERT_TRUE(edit(ann, std::move(entries)).accepted);
    }
    void paint_all(float red) {
        std::vector<Entry> entries;
        for (int i = 0; i < Objects; ++i) {
            entries.push_back(Update{id(i), Fields<Material>(&Material::base_color).bits(),
                                     Material{.base_color = {red, 0, 0, 1}}});
        }
        ASSERT_TRUE(edit(ann, std::move(entries)).accepted);
    }
    ObjectId id(int i) const { return ObjectId{ann.ids.first + static_cast<std::uint64_t>(i)}; }
};

// If as many objects move at every version, snapshots would be sent for ever.
TEST_F(SceneDistributorTest, ANodeThatIsBehindByALongListGetsTheListNotTheScene) {
    distributor.joined(node, TimePoint{});
    EXPECT_EQ(node.sent, authority.version()) << "a short scene is sent at once";
    create_all();
    publish();
    paint_all(0.5f);
    publish();  // while the version before is encoded
    const Version latest = authority.version();
    const EncodedScene first = next();
    distributor.take(first, nodes, TimePoint{});
    EXPECT_NE(node.awaits, 0u);
    const EncodedScene second = next();
    EXPECT_EQ(second.from, first.to) << "what has changed since";
    distributor.take(second, nodes, TimePoint{});
    EXPECT_EQ(node.sent, latest);
    EXPECT_EQ(node.awaits, 0u);
}

TEST_F(SceneDistributorTest, AListIsEncodedOnceForAllNodes) {
    NodeRecord& other = nodes.add(NodeId{2}, 2, 2, "node", wire::Hello{}, TimePoint{});
    for (NodeRecord* joined : {&node, &other}) distributor.joined(*joined, TimePoint{});
    create_all();
    publish();
    EXPECT_EQ(node.awaits, other.awaits);
    distributor.take(next(), nodes, TimePoint{});
    EXPECT_EQ(node.sent, authority.version());
    EXPECT_EQ(other.sent, authority.version());
    EXPECT_TRUE(made.empty());
}

}  // namespace
}  // namespace tessera::master

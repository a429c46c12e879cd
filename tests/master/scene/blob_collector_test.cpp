#include "master/scene/blob_collector.h"

#include <gtest/gtest.h>

namespace tessera::master {
namespace {

// A key that renders one scene after another may send its quota for each.
TEST(BlobCollectorTest, TheQuotaIsGivenBackWhenASceneIsClosed) {
    const auto store = std::make_shared<scene::BlobStore>();
    BlobCollector collector(store, Duration::zero());
    const scene::BlobRef gone = scene::reference(*store->insert(std::vector<std::byte>(100, std::byte{1})));
    const scene::BlobPtr kept = store->insert(std::vector<std::byte>(10, std::byte{2}));
    collector.received("ann", gone);
    collector.received("ann", gone);
    collector.received("ann", scene::reference(*kept));
    collector.received("bob", gone);
    EXPECT_EQ(collector.held_bytes("ann"), 110u) << "each blob once";
    EXPECT_EQ(collector.held_bytes("bob"), 0u) << "of the key that sent it first";
    store->erase_unused();
    collector.scene_closed();
    EXPECT_EQ(collector.held_bytes("ann"), 10u);
    collector.received("bob", gone);
    EXPECT_EQ(collector.held_bytes("bob"), 100u);
}

}  // namespace
}  // namespace tessera::master

// Session folders written by older masters can be read.
#include <gtest/gtest.h>

#include "mediator/wire/journal_codec.h"
#include "proto/journal.pb.h"

namespace tessera::wire::test {
namespace {

// Older folders store a view with its samples instead of a view request.
TEST(OlderFolders, AViewWithoutARequestIsRead) {
    CheckpointState state;
    state.scene.to = {1, 1};
    state.views.push_back({.name = "main"});
    state.views[0].request.view.width = 64;
    state.views[0].request.stop.spp = 16;
    proto::Checkpoint older;
    const std::vector<std::byte> bytes = encode(state);
    ASSERT_TRUE(older.ParseFromArray(bytes.data(), int(bytes.size())));
    proto::JournalView& view = *older.mutable_views(0);
    EXPECT_FALSE(view.has_view());
    *view.mutable_view() = view.request().view();
    view.set_spp(view.request().stop().spp());
    view.clear_request();
    older.clear_owner();
    const std::string text = older.SerializeAsString();
    const auto read = decode_checkpoint(std::as_bytes(std::span(text)));
    ASSERT_TRUE(read) << read.error().what();
    EXPECT_EQ(read->views.at(0).request.view.width, 64u);
    EXPECT_EQ(read->views.at(0).request.stop.spp, 16u);
    EXPECT_EQ(read->views.at(0).request.frames, session::Frames::All);
    EXPECT_FALSE(read->owner);
}

}  // namespace
}  // namespace tessera::wire::test

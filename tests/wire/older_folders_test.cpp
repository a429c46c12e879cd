// Session folders written by older masters can be read.
#include <gtest/gtest.h>

#include <algorithm>

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

// Older films have no mask.
TEST(OlderFolders, FilmOfAllPixelsIsRead) {
    frame::FilmTile film({3, 5, 2, 1}, {4, 1}, {frame::Channel::Depth});
    film.counts = {2, 1};
    film.nonfinite_samples = 1;
    film.planes.assign(film.planes.size(), 0.5f);
    std::vector<std::byte> older;
    const auto put = [&](auto value) {
        const auto bytes = std::as_bytes(std::span(&value, 1));
        older.insert(older.end(), bytes.begin(), bytes.end());
    };
    for (const std::int32_t number : {3, 5, 2, 1}) put(number);
    put(std::uint64_t{4});
    put(std::uint32_t{1});
    put(static_cast<std::uint32_t>(film.channels.words()[0]));
    put(std::uint64_t{1});
    put(std::uint8_t{0});
    for (const std::uint32_t count : film.counts) put(count);
    for (const float value : film.planes) put(value);
    std::vector<std::byte> bytes = encode_film(film);  // after the fields of a message
    ASSERT_GT(bytes.size(), older.size());
    const auto begin = bytes.end() - static_cast<std::ptrdiff_t>(older.size());
    EXPECT_TRUE(std::equal(begin, bytes.end(), older.begin()));
    std::ranges::copy(older, begin);
    const auto read = decode_film(bytes);
    ASSERT_TRUE(read) << read.error().what();
    EXPECT_TRUE(identical_bits(*read, film));
}

}  // namespace
}  // namespace tessera::wire::test

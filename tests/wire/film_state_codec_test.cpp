// Film that a client sends: what was encoded, and nothing else.
#include "mediator/wire/film_state_codec.h"

#include <gtest/gtest.h>

#include <limits>

namespace tessera::wire {
namespace {

frame::FilmState some_film() {
    const Rect tile{8, 0, 8, 4};
    frame::FilmTile block(tile, {0, 4}, {frame::Channel::Radiance, frame::Channel::Depth});
    for (std::uint32_t& count : block.counts) count = 16;
    frame::FilmTile more(tile, {16, 4}, block.channels, frame::PixelSet({1, 5, 31}, 32));
    more.counts = {16, 15, 16};
    more.nonfinite_samples = 1;
    return {
        .blocks = {block, more},
        .steps = 3,
        .wanted = {{tile, {16, 4}, frame::PixelSet({0, 2}, 32)}, {tile, {32, 5}, frame::PixelSet({1}, 32)}}};
}

TEST(FilmStateCodec, RestoresWhatItEncoded) {
    const frame::FilmState before = some_film();
    const auto after = decode_film_state(encode(before));
    ASSERT_TRUE(after) << after.error().what();
    EXPECT_EQ(after->steps, 3u);
    ASSERT_EQ(after->blocks.size(), 2u);
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_TRUE(frame::identical_bits(after->blocks[i], before.blocks[i]));
        EXPECT_EQ(after->blocks[i].pixels, before.blocks[i].pixels);
        EXPECT_EQ(after->blocks[i].block, before.blocks[i].block);
    }
    ASSERT_EQ(after->wanted.size(), 2u);
    EXPECT_EQ(after->wanted[0].pixels, before.wanted[0].pixels);
    EXPECT_EQ(after->wanted[1].block, before.wanted[1].block);
    EXPECT_TRUE(decode_film_state(encode(frame::FilmState{}))->blocks.empty());
}

TEST(FilmStateCodec, RefusesDamage) {
    const std::vector<std::byte> good = encode(some_film());
    for (std::size_t size = 0; size < good.size(); ++size) {
        const auto cut = decode_film_state(std::span(good).first(size));
        // Between two blocks it may end.
        if (cut) EXPECT_LT(cut->blocks.size() + cut->wanted.size(), 4u) << size;
    }
    std::vector<std::byte> other = good;
    for (std::size_t at = 0; at < good.size(); ++at) {
        for (const int value : {0, 1, 0x7f, 0xff}) {
            other[at] = static_cast<std::byte>(value);
            (void)decode_film_state(other);  // no crash, no absurd allocation
        }
        other[at] = good[at];
    }
}

TEST(FilmStateCodec, RefusesFilmThatNoNodeWouldSend) {
    const auto is_refused = [](const frame::FilmState& film) { return !decode_film_state(encode(film)); };
    frame::FilmState film = some_film();
    film.blocks[0].counts[3] = 17;
    EXPECT_TRUE(is_refused(film)) << "more samples than the block";
    film = some_film();
    film.blocks[1].nonfinite_samples = 0;
    EXPECT_TRUE(is_refused(film)) << "counts that do not add up";
    film = some_film();
    film.blocks[0].planes[0] = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(is_refused(film)) << "a mean that is no number";
    film = some_film();
    film.blocks[0].block = {8, 4};
    EXPECT_TRUE(is_refused(film)) << "a block that is not aligned";
}

}  // namespace
}  // namespace tessera::wire

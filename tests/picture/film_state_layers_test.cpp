// Films in progress as layers of an EXR, and back.
#include "mediator/picture/film_state_layers.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "mediator/frame/block_stack.h"
#include "mediator/frame/merge.h"
#include "mediator/frame/tile_film.h"
#include "mediator/picture/exr_reader.h"
#include "mediator/picture/film_exr.h"

namespace tessera::picture {
namespace {

using frame::Channel;
using frame::FilmTile;
using frame::PixelSet;
using frame::SampleBlock;

const frame::ChannelSet Channels{Channel::Radiance, Channel::Depth, Channel::BlockVariance};

// Samples of any values; those of a pixel and number are always the same.
FilmTile samples(const Rect& tile, const SampleBlock& block, const PixelSet& pixels = {}) {
    frame::BlockStack stack;
    for (std::uint64_t sample = block.first; sample < block.end(); ++sample) {
        FilmTile one(tile, {sample, 0}, Channels, pixels);
        for (std::size_t i = 0; i < one.pixel_count(); ++i) {
            std::mt19937 random(static_cast<unsigned>(1000 * sample + one.pixels.index(i) + tile.x));
            std::uniform_real_distribution<float> value(0.0f, 2.0f);
            if (random() % 50 == 0) {  // rejected
                ++one.nonfinite_samples;
                continue;
            }
            one.counts[i] = 1;
            for (std::uint32_t c = 0; c < 3; ++c) one.plane(c)[i] = value(random);
            one.plane(Channels.first_plane(Channel::Depth))[i] = value(random);
        }
        stack.push(std::move(one));
    }
    return std::move(stack.take().front());
}

struct SavedFilm : testing::Test {
    std::string path =
        (std::filesystem::temp_directory_path() / ("tessera-state-" + std::to_string(::getpid()) + ".exr"))
            .string();
    Rect window{0, 0, 24, 12};
    std::vector<frame::TileFilm> tiles = std::vector<frame::TileFilm>(3);
    std::vector<Rect> rects{{0, 0, 10, 10}, {10, 0, 10, 10}, {20, 0, 4, 10}};

    ~SavedFilm() override { std::filesystem::remove(path); }
    void SetUp() override {
        for (const Rect& row : {Rect{0, 10, 10, 2}, Rect{10, 10, 10, 2}, Rect{20, 10, 4, 2}})
            rects.push_back(row);
        tiles.resize(rects.size());
    }
    void all_get(const SampleBlock& block) {
        for (std::size_t i = 0; i < tiles.size(); ++i)
            EXPECT_EQ(tiles[i].insert(samples(rects[i], block)), frame::TileFilm::Outcome::Merged);
    }
    FilmFile file() const {
        FilmFile file{.width = 24, .height = 12, .film = FilmTile(window, {}, Channels), .attributes = {}};
        file.state.emplace();
        for (const frame::TileFilm& tile : tiles) {
            paste(file.film, tile.merged());
            for (FilmTile& block : tile.blocks(frame::TileFilm::Parts::LeftOut))
                file.state->blocks.push_back(std::move(block));
        }
        return file;
    }
    FilmFile written_and_read(const FilmFile& file) const {
        write_film_exr(path, file, {}, Statistics::Include);
        return read_film_exr(path, State::Included);
    }
    static void expect_same(const frame::FilmState& a, const frame::FilmState& b) {
        ASSERT_EQ(a.blocks.size(), b.blocks.size());
        for (const FilmTile& block : a.blocks) {
            const auto same = [&](const FilmTile& other) {
                return other.rect == block.rect && other.block == block.block &&
                       other.pixels == block.pixels && identical_bits(other, block) &&
                       other.nonfinite_samples == block.nonfinite_samples;
            };
            EXPECT_TRUE(std::ranges::any_of(b.blocks, same)) << block.rect.x << " " << block.block.first;
        }
    }
};

TEST_F(SavedFilm, OfOneBlockNeedsNoPlanes) {
    all_get({0, 4});
    const FilmFile before = file(), after = written_and_read(before);
    ASSERT_TRUE(after.state);
    expect_same(*before.state, *after.state);
    EXPECT_EQ(state_layers(before.film, *before.state).size(), 2u);
    EXPECT_FALSE(read_film_exr(path).state);
}

TEST_F(SavedFilm, KeepsTheBlocksOf48Samples) {
    all_get({0, 5});
    all_get({32, 4});
    const FilmFile before = file(), after = written_and_read(before);
    ASSERT_TRUE(after.state);
    expect_same(*before.state, *after.state);
    EXPECT_EQ(after.state->blocks.size(), 2 * rects.size());
    EXPECT_EQ(before.film.counts, after.film.counts);
    EXPECT_EQ(before.film.planes, after.film.planes);
}

TEST_F(SavedFilm, KeepsBlocksThatDifferFromTileToTile) {
    all_get({0, 3});
    tiles[1].insert(samples(rects[1], {8, 1}));
    tiles[1].insert(samples(rects[1], {12, 2}));
    tiles[4].insert(samples(rects[4], {8, 3}));
    const FilmFile before = file(), after = written_and_read(before);
    ASSERT_TRUE(after.state);
    expect_same(*before.state, *after.state);
}

TEST_F(SavedFilm, KeepsTheSamplesOfEachPixelAndTheStepThatItIsIn) {
    all_get({0, 4});
    const PixelSet some({1, 5, 17, 99}, 100), fewer({5, 17}, 100), left({0, 2, 40}, 100);
    tiles[1].insert(samples(rects[1], {16, 4}, some));
    tiles[1].insert(samples(rects[1], {32, 5}, fewer));
    FilmFile before = file();
    before.state->steps = 2;
    before.state->wanted = {{rects[0], {16, 4}, left}, {rects[1], {32, 5}, PixelSet({1}, 100)}};
    const FilmFile after = written_and_read(before);
    ASSERT_TRUE(after.state);
    expect_same(*before.state, *after.state);
    EXPECT_EQ(after.state->steps, 2u);
    ASSERT_EQ(after.state->wanted.size(), 2u);
    EXPECT_EQ(after.state->wanted[0].pixels, left);
    EXPECT_EQ(after.state->wanted[1].block, (SampleBlock{32, 5}));
}

TEST_F(SavedFilm, OfDamagedBlocksIsRefused) {
    all_get({0, 4});
    const FilmFile good = file();
    PixelBlocks slot{good.film, std::vector<std::uint32_t>(good.film.pixel_count(), 0),
                     std::vector<std::uint32_t>(good.film.pixel_count(), 16)};
    EXPECT_EQ(state_of({slot}, {}, 0, 10).blocks.size(), rects.size());
    for (const auto& [first, size] :
         std::vector<std::pair<std::uint32_t, std::uint32_t>>{{0, 3}, {8, 16}, {0, 8}, {1, 0xffffffff}}) {
        PixelBlocks damaged = slot;
        damaged.first[7] = first;
        damaged.size[7] = size;
        EXPECT_THROW(state_of({damaged}, {}, 0, 10), Error) << first << " " << size;
    }
}

}  // namespace
}  // namespace tessera::picture

// A step that was interrupted goes on with what its film lacks.
#include "master/render/adaptive/saved_step.h"

#include <gtest/gtest.h>

#include <array>

namespace tessera::master {
namespace {

using frame::PixelSet;

constexpr std::array Tiles{Rect{0, 0, 4, 2}, Rect{4, 0, 2, 2}};

frame::FilmTile block(std::uint32_t tile, const frame::SampleBlock& samples, const PixelSet& pixels = {}) {
    frame::FilmTile film(Tiles[tile], samples, {frame::Channel::Radiance}, pixels);
    film.counts.assign(film.pixel_count(), static_cast<std::uint32_t>(samples.count()));
    return film;
}

RoundMask mask_of(std::uint32_t tile, std::vector<std::uint32_t> pixels) {
    const PixelSet set(std::move(pixels), Tiles[tile].pixel_count());
    return {set.bits(Tiles[tile].pixel_count()),
            static_cast<std::uint32_t>(set.count(Tiles[tile].pixel_count()))};
}

struct SavedSteps : testing::Test {
    FrameAssembler film{{Tiles.begin(), Tiles.end()}, {frame::Channel::Radiance}, 1024};
    // Pixels 1, 2 and 5 of the first tile, and all of the second.
    std::vector<Round> rounds{{{16, 4},
                               std::make_shared<const std::vector<RoundMask>>(
                                   std::vector{mask_of(0, {1, 2, 5}), mask_of(1, {0, 1, 2, 3})})}};

    SavedSteps() {
        for (std::uint32_t tile = 0; tile < 2; ++tile) (void)film.insert(block(tile, {0, 4}), {});
    }
    // The pixels of each tile, all of them written out.
    std::vector<std::vector<std::uint32_t>> remaining(const std::vector<wire::SavedPart>& step) const {
        const std::vector<Round> left = remaining_rounds(step, film);
        EXPECT_LE(left.size(), 1u);
        std::vector<std::vector<std::uint32_t>> pixels(Tiles.size());
        for (std::size_t tile = 0; tile < Tiles.size() && !left.empty(); ++tile) {
            const RoundMask& mask = (*left[0].masks)[tile];
            if (mask.pixels == 0) continue;
            const auto set = PixelSet::from_bits(mask.bits, Tiles[tile].pixel_count());
            for (std::size_t i = 0; i < mask.pixels; ++i) pixels[tile].push_back(set->index(i));
        }
        return pixels;
    }
};

using Pixels = std::vector<std::vector<std::uint32_t>>;

TEST_F(SavedSteps, LackWhatTheirFilmDoesNotHave) {
    const std::vector<wire::SavedPart> saved = saved_step(rounds, Tiles);
    ASSERT_EQ(saved.size(), 2u);
    EXPECT_EQ(saved[1].mask, "") << "all pixels";
    EXPECT_EQ(remaining(saved), (Pixels{{1, 2, 5}, {0, 1, 2, 3}}));
    (void)film.insert(block(0, {16, 3}, PixelSet({1, 2, 5}, 8)), {});
    EXPECT_EQ(remaining(saved), (Pixels{{1, 2, 5}, {0, 1, 2, 3}})) << "half of a part is not saved";
    (void)film.insert(block(0, {24, 3}, PixelSet({1, 2, 5}, 8)), {});
    EXPECT_EQ(remaining(saved), (Pixels{{}, {0, 1, 2, 3}}));
    (void)film.insert(block(1, {16, 4}), {});
    EXPECT_TRUE(remaining_rounds(saved, film).empty());
}

// Folders may be damaged, or of another version.
TEST_F(SavedSteps, WithPartsThatDoNotFitTheFilmLackNothingOfThem) {
    const wire::SavedPart good = saved_step(rounds, Tiles)[0];
    const auto with = [&](auto change) {
        wire::SavedPart part = good;
        change(part);
        return remaining_rounds(std::vector{part}, film).empty();
    };
    EXPECT_FALSE(with([](wire::SavedPart&) {}));
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.tile.x = 1; }));
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.tile = {}; }));
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.block = {32, 4}; }));
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.block = {32, 5}; })) << "they have 16 samples";
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.block = {0, 0}; }));
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.block = {16, 4000000000}; }));
    EXPECT_TRUE(with([](wire::SavedPart& part) { part.mask = "long mask"; }));
    // Twice the same part.
    EXPECT_EQ(remaining({good, good}), (Pixels{{1, 2, 5}, {}}));
}

}  // namespace
}  // namespace tessera::master

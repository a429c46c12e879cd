#include "mediator/frame/tile_film.h"

#include <gtest/gtest.h>

#include "tests/frame/film_fixture.h"

namespace tessera::frame {
namespace {

using Outcome = TileFilm::Outcome;

constexpr std::size_t Pixels = SmallTile.pixel_count();
constexpr std::uint32_t BaseLevel = 2, Levels = 4;  // 4 samples of all pixels, up to 64 of some

// Some pixels of a block.
FilmTile part_of(const SampleBlock& block, const std::vector<std::uint32_t>& indices) {
    FilmTile film = with_pixels(canonical_film(block), PixelSet(indices, Pixels));
    std::uint64_t accepted = 0;
    for (const std::uint32_t count : film.counts) accepted += count;
    film.nonfinite_samples = block.count() * film.pixel_count() - accepted;
    return film;
}

void shuffle_parts(std::vector<FilmTile>& values, CounterRandom& random) {
    for (std::size_t i = values.size(); i > 1; --i) std::swap(values[i - 1], values[random.below(i)]);
}

// Pixel by pixel the block of all its samples.
FilmTile expected_film(const std::vector<std::uint32_t>& doublings) {
    FilmTile film(SmallTile, {0, BaseLevel}, SomeChannels);
    for (std::uint32_t i = 0; i < Pixels; ++i) paste(film, part_of({0, BaseLevel + doublings[i]}, {i}));
    return film;
}

// Parts of the levels of pixels that were doubled so often: those of each level in random sets, as random blocks.
std::vector<FilmTile> random_parts(const std::vector<std::uint32_t>& doublings, CounterRandom& random) {
    std::vector<FilmTile> parts;
    for (std::uint32_t level = BaseLevel; level < BaseLevel + Levels; ++level) {
        std::vector<std::vector<std::uint32_t>> sets(1 + random.below(3));
        for (std::uint32_t i = 0; i < Pixels; ++i) {
            if (BaseLevel + doublings[i] > level) sets[random.below(sets.size())].push_back(i);
        }
        for (const std::vector<std::uint32_t>& set : sets) {
            if (set.empty()) continue;
            std::vector<SampleBlock> blocks{{std::uint64_t{1} << level, level}};
            for (std::size_t i = 0; i < blocks.size(); ++i) {
                while (blocks[i].level > 0 && random.below(2) == 0) {
                    --blocks[i].level;
                    blocks.push_back(blocks[i].sibling());
                }
            }
            for (const SampleBlock& block : blocks) parts.push_back(part_of(block, set));
        }
    }
    return parts;
}

TEST(TileFilm, APixelsBitsDependOnItsSamplesAlone) {
    CounterRandom random(3);
    for (int round = 0; round < 60; ++round) {
        std::vector<std::uint32_t> doublings(Pixels);
        for (std::uint32_t& count : doublings) count = static_cast<std::uint32_t>(random.below(Levels + 1));
        std::vector<FilmTile> parts = random_parts(doublings, random);
        parts.push_back(canonical_film({0, BaseLevel}));
        shuffle_parts(parts, random);
        TileFilm film;
        for (const FilmTile& part : parts) EXPECT_EQ(film.insert(part), Outcome::Merged);
        EXPECT_TRUE(identical_bits(film.merged(), expected_film(doublings)));
        const std::vector<std::uint8_t> known = film.doublings();
        for (std::size_t i = 0; i < Pixels; ++i) EXPECT_EQ(known[i], BaseLevel + doublings[i]);
        for (const FilmTile& part : parts) {
            EXPECT_EQ(film.insert(part), Outcome::Duplicate);
        }
        TileFilm again;
        for (const FilmTile& block : film.blocks(TileFilm::Parts::LeftOut)) again.insert(block);
        EXPECT_TRUE(identical_bits(again.merged(), film.merged()));
    }
}

TEST(TileFilm, ShowsPartsOfBlocksAsWell) {
    TileFilm film;
    film.insert(canonical_film({0, 2}));
    film.insert(part_of({4, 1}, {1, 7}));
    const FilmTile merged = film.merged();
    FilmTile expected = part_of({0, 2}, {1, 7});
    merge(expected, part_of({4, 1}, {1, 7}));
    EXPECT_TRUE(identical_bits(with_pixels(merged, expected.pixels), [&] {
        expected.nonfinite_samples = 0;
        return expected;
    }()));
    EXPECT_EQ(film.doublings()[1], 2u) << "its block is not complete";
    EXPECT_EQ(film.blocks(TileFilm::Parts::LeftOut).size(), 1u);
    EXPECT_EQ(film.blocks(TileFilm::Parts::Included).size(), 2u);
}

TEST(TileFilm, RejectsWhatNoScheduleAsksFor) {
    TileFilm film;
    film.insert(canonical_film({0, 2}));
    EXPECT_EQ(film.insert(part_of({0, 2}, {1})), Outcome::Overlap) << "all pixels have these";
    EXPECT_EQ(film.insert(part_of({2, 1}, {1})), Outcome::Duplicate);
    EXPECT_EQ(film.insert(part_of({4, 1}, {1, 7})), Outcome::Merged);
    EXPECT_EQ(film.insert(part_of({4, 1}, {7, 9})), Outcome::Overlap) << "a pixel of another part";
    FilmTile forged = part_of({4, 1}, {1, 7});
    forged.planes[0] += 1.0f;
    EXPECT_EQ(film.insert(forged), Outcome::Conflict);
    EXPECT_EQ(film.insert(part_of({6, 1}, {1, 7})), Outcome::Merged);
    EXPECT_EQ(film.insert(part_of({6, 1}, {7})), Outcome::Duplicate);
}

}  // namespace
}  // namespace tessera::frame

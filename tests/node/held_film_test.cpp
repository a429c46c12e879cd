#include "node/held_film.h"

#include <gtest/gtest.h>

#include "mediator/base/random.h"
#include "mediator/frame/merge.h"

namespace tessera::node {
namespace {

using frame::SampleBlock;
using namespace std::chrono_literals;

constexpr frame::ChannelSet Channels{frame::Channel::Radiance};

frame::FilmTile canonical(const SampleBlock& block) {
    if (block.level > 0) {
        const SampleBlock half{block.first, block.level - 1};
        frame::FilmTile film = canonical(half);
        merge(film, canonical(half.sibling()));
        return film;
    }
    frame::FilmTile film({0, 0, 4, 4}, block, Channels);
    CounterRandom random(block.first);
    for (std::size_t pixel = 0; pixel < film.pixel_count(); ++pixel) {
        const std::array<float, 3> values{static_cast<float>(random.uniform()),
                                          static_cast<float>(random.uniform()),
                                          static_cast<float>(random.uniform())};
        put_sample(film, pixel, values);
    }
    return film;
}

wire::FilmPart part(std::uint64_t unit, const SampleBlock& block) {
    return {.unit = UnitId{unit},
            .view = ViewId{1},
            .revision = 1,
            .version = {1, 1},
            .rays = 10,
            .busy_ns = 5,
            .film = canonical(block)};
}

struct HeldFilmTest : testing::Test {
    HeldFilm held;
    TimePoint now{1h};
    bool more_is_coming = true;

    std::vector<HeldFilm::Item> take_ready() {
        return held.take_ready([this](const wire::FilmPart&) { return more_is_coming; },
                               [](ViewId) { return Duration(1s); }, now);
    }
};

TEST_F(HeldFilmTest, MergesSiblingsInAnyOrderToTheCanonicalBits) {
    std::vector<std::uint64_t> order{0, 1, 2, 3, 4, 5, 6, 7};
    CounterRandom random(3);
    for (int round = 0; round < 20; ++round) {
        for (std::size_t i = order.size(); i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
        for (const std::uint64_t first : order) held.add(part(first + 1, {first, 0}), now);
        more_is_coming = false;
        const auto items = take_ready();
        ASSERT_EQ(items.size(), 1u);
        EXPECT_TRUE(identical_bits(items[0].film.film, canonical({0, 3})));
        EXPECT_EQ(items[0].film.film.block, (SampleBlock{0, 3}));
        EXPECT_EQ(items[0].units.size(), 8u);
        EXPECT_EQ(items[0].film.units, 8u);
        EXPECT_EQ(items[0].film.rays, 80u);
        EXPECT_EQ(items[0].film.busy_ns, 40u);
    }
}

TEST_F(HeldFilmTest, KeepsFilmOfOtherViewsVersionsAndTilesApart) {
    held.add(part(1, {0, 0}), now);
    wire::FilmPart other = part(2, {1, 0});
    other.version.number = 2;
    held.add(other, now);
    other = part(3, {1, 0});
    other.revision = 2;
    held.add(other, now);
    other = part(4, {1, 0});
    other.film.rect.x = 4;
    held.add(other, now);
    held.add(part(5, {2, 0}), now);  // adjacent, but not the other half
    EXPECT_EQ(held.take_all().size(), 5u);
}

TEST_F(HeldFilmTest, WaitsForTheOtherHalfButNotForLong) {
    held.add(part(1, {0, 0}), now);
    EXPECT_TRUE(take_ready().empty());
    now += 999ms;
    held.add(part(2, {1, 0}), now);  // the age is that of the oldest sample
    EXPECT_TRUE(take_ready().empty());
    now += 1ms;
    EXPECT_EQ(take_ready().size(), 1u);
    EXPECT_TRUE(held.empty());
}

TEST_F(HeldFilmTest, KnowsWhatBelongsToTheOtherHalf) {
    const wire::FilmPart film = part(1, {4, 1});  // samples 4, 5
    view::WorkUnit unit{.view = ViewId{1}, .revision = 1, .version = {1, 1}, .tile = {0, 0, 4, 4}};
    const auto is_other_half = [&](const SampleBlock& block) {
        unit.block = block;
        return is_in_other_half(film, unit);
    };
    EXPECT_TRUE(is_other_half({6, 1}));
    EXPECT_TRUE(is_other_half({7, 0}));
    EXPECT_FALSE(is_other_half({8, 1}));
    EXPECT_FALSE(is_other_half({2, 1}));
    EXPECT_FALSE(is_other_half({4, 2})) << "a unit that contains the film makes it superfluous";
    unit.tile.x = 4;
    EXPECT_FALSE(is_other_half({6, 1}));
}

TEST_F(HeldFilmTest, GivesUpTheFilmOfAUnitOrAView) {
    held.add(part(1, {0, 0}), now);
    held.add(part(2, {1, 0}), now);
    EXPECT_FALSE(held.take(UnitId{9}));
    EXPECT_EQ(held.take(UnitId{2})->units.size(), 2u);
    held.add(part(3, {0, 0}), now);
    EXPECT_TRUE(held.take_view(ViewId{2}).empty());
    EXPECT_EQ(held.take_view(ViewId{1}).size(), 1u);
    EXPECT_TRUE(held.empty());
}

}  // namespace
}  // namespace tessera::node

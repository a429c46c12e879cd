// The values of single samples, of every back-end in the catalog.
#include <algorithm>
#include <bit>
#include <cmath>

#include "mediator/base/random.h"
#include "mediator/frame/merge.h"
#include "tests/contract/backend_contract.h"

namespace tessera::backend {
namespace {

using frame::FilmTile;

struct BackendSamples : BackendContract {};

double root_of(double radiance) {
    return 2.0 * (std::sqrt(std::max(radiance, 0.0)) - 1.0);
}

TEST_P(BackendSamples, TheChannelsOfASampleAreConsistent) {
    using frame::Channel;
    const FilmTile film = render(*backend, whole, {6, 0});
    const auto value = [&](Channel channel, std::uint32_t component, std::size_t pixel) {
        return film.plane(view.channels.first_plane(channel) + component)[pixel];
    };
    for (std::size_t pixel = 0; pixel < whole.pixel_count(); ++pixel) {
        const bool hit = std::isfinite(value(Channel::Depth, 0, pixel));
        ASSERT_EQ(value(Channel::Alpha, 0, pixel), hit ? 1.0f : 0.0f);
        ASSERT_EQ(std::bit_cast<std::uint32_t>(value(Channel::ObjectIndex, 1, pixel)) != 0, hit);
        ASSERT_EQ(value(Channel::FirstHalf, 3, pixel), 0.0f);
        ASSERT_EQ(value(Channel::BlockVariance, 0, pixel), 0.0f);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const float radiance = value(Channel::Radiance, c, pixel);
            ASSERT_EQ(radiance,
                      value(Channel::LowVariance, c, pixel) + value(Channel::HighVariance, c, pixel));
            ASSERT_EQ(value(Channel::Color, c, pixel), radiance);
            const double root = root_of(radiance);
            ASSERT_NEAR(value(Channel::Root, c, pixel), root, 1e-6 * (2.0 + std::abs(root)));
            ASSERT_GE(value(Channel::Headlight, c, pixel), 0.0f);
            ASSERT_LE(value(Channel::Headlight, c, pixel), 1.0f);
            if (!hit) {
                ASSERT_EQ(value(Channel::Albedo, c, pixel), 0.0f);
                ASSERT_EQ(value(Channel::Normal, c, pixel), 0.0f);
            }
        }
    }
    // The first half of a block is the block of its first half.
    const FilmTile four = render(*backend, whole, {4, 2}), two = render(*backend, whole, {4, 1});
    for (std::uint32_t c = 0; c < 3; ++c) {
        const auto half = four.plane(view.channels.first_plane(Channel::FirstHalf) + c);
        ASSERT_TRUE(std::ranges::equal(half, two.plane(view.channels.first_plane(Channel::Radiance) + c)));
    }
}

// Some pixels of a tile have the bits that they have among all, however few they are, also in merged blocks.
TEST_P(BackendSamples, APixelOfAMaskIsThatOfTheWholeTile) {
    const Rect tile{8, 4, 31, 17};
    const FilmTile all = render(*backend, tile, {8, 3});
    CounterRandom random(8);
    for (const std::uint64_t one_of : {2u, 20u, 600u}) {
        std::vector<std::uint32_t> indices{static_cast<std::uint32_t>(random.below(tile.pixel_count()))};
        for (std::uint32_t i = 0; i < tile.pixel_count(); ++i) {
            if (random.below(one_of) == 0) indices.push_back(i);
        }
        std::ranges::sort(indices);
        indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
        const frame::PixelSet pixels(indices, tile.pixel_count());
        view::WorkUnit work = unit(tile, {8, 3});
        work.mask = pixels.bits(tile.pixel_count());
        const RenderResult result = backend->render(view, work, {});
        ASSERT_EQ(result.blocks.size(), 1u);
        const FilmTile& some = result.blocks[0];
        EXPECT_EQ(some.pixels, pixels);
        EXPECT_EQ(some.pixel_count(), indices.size());
        FilmTile expected = with_pixels(all, pixels);
        expected.nonfinite_samples = some.nonfinite_samples;
        EXPECT_TRUE(identical_bits(some, expected)) << indices.size() << " pixels";
        EXPECT_GE(result.rays, 8 * indices.size());
    }
}

TEST_P(BackendSamples, RootHasTheMomentsOfTheTransformedSamples) {
    using frame::Channel;
    constexpr std::uint64_t Count = 8;
    const FilmTile film = render(*backend, whole, {0, 3});
    std::vector<FilmTile> samples;
    for (std::uint64_t i = 0; i < Count; ++i) samples.push_back(render(*backend, whole, {i, 0}));
    const std::uint32_t root = view.channels.first_plane(Channel::Root);
    double variances = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t pixel = 0; pixel < whole.pixel_count(); ++pixel) {
            double mean = 0.0, m2 = 0.0;
            const auto transformed = [&](const FilmTile& one) {
                return root_of(one.plane(view.channels.first_plane(Channel::Radiance) + c)[pixel]);
            };
            for (const FilmTile& one : samples) mean += transformed(one) / Count;
            for (const FilmTile& one : samples) m2 += std::pow(transformed(one) - mean, 2);
            ASSERT_NEAR(film.plane(root + c)[pixel], mean, 1e-6 * (2.0 + std::abs(mean)));
            ASSERT_NEAR(film.plane(root + 3 + c)[pixel], m2, 1e-4 * (0.01 + m2));
            variances += m2;
        }
    }
    EXPECT_GT(variances, 0.0);
}

// Each sample for itself: it never adds light, does not change direct light, and a limit that nothing reaches
// changes no bit.
TEST_P(BackendSamples, AClampLimitsIndirectLightAlone) {
    const FilmTile free = render(*backend, whole, {0, 0});
    view.clamp_indirect = 1e30f;
    EXPECT_TRUE(frame::identical_bits(free, render(*backend, whole, {0, 0})));
    view.clamp_indirect = 1e-3f;
    const FilmTile clamped = render(*backend, whole, {0, 0});
    const auto plane = [&](const FilmTile& film, frame::Channel channel, std::uint32_t c) {
        return film.plane(view.channels.first_plane(channel) + c);
    };
    double before = 0.0, after = 0.0;
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::size_t pixel = 0; pixel < whole.pixel_count(); ++pixel) {
            ASSERT_EQ(plane(clamped, frame::Channel::LowVariance, c)[pixel],
                      plane(free, frame::Channel::LowVariance, c)[pixel]);
            const float most = plane(free, frame::Channel::HighVariance, c)[pixel],
                        rest = plane(clamped, frame::Channel::HighVariance, c)[pixel];
            ASSERT_LE(rest, most);
            ASSERT_LE(rest, 0.1f) << "up to 2 contributions at each of 50 vertices";
            before += most;
            after += rest;
        }
    }
    EXPECT_GT(after, 0.0);
    EXPECT_LT(after, 0.5 * before);
}

INSTANTIATE_TEST_SUITE_P(Catalog, BackendSamples, testing::ValuesIn(BackendSamples::names()),
                         [](const auto& entry) { return entry.param; });

}  // namespace
}  // namespace tessera::backend

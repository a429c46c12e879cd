// The contract of every back-end in the catalog.
#include "tests/contract/backend_contract.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <thread>

#include "mediator/frame/merge.h"
#include "mediator/frame/render_revision.h"
#include "tests/numerics/float_mode.h"

namespace tessera::backend {
namespace {

using frame::FilmTile;
using frame::SampleBlock;

TEST_P(BackendContract, ReportsItsCapabilities) {
    const Capabilities capabilities = backend->capabilities();
    EXPECT_TRUE(capabilities.channels.contains(frame::Channel::Radiance));
    EXPECT_GE(capabilities.preferred_tile, 1u);
    EXPECT_GE(capabilities.concurrent_units, 1u);
    EXPECT_TRUE(capabilities.kind.ends_with(frame::with_render_revision(""))) << capabilities.kind;
    EXPECT_GT(capabilities.kind.size(), frame::with_render_revision("").size());
    EXPECT_EQ(fresh()->capabilities().kind, capabilities.kind);
}

TEST_P(BackendContract, RejectsAUnitOfAnotherVersion) {
    view::WorkUnit work = unit(whole, {0, 0});
    ++work.version.number;
    EXPECT_EQ(backend->render(view, work, {}).status, RenderStatus::Refused);
    work.version = backend->version();
    ++work.version.epoch;
    EXPECT_EQ(backend->render(view, work, {}).status, RenderStatus::Refused);
}

TEST_P(BackendContract, CountsEverySampleOnce) {
    const FilmTile film = render(*backend, whole, {16, 3});
    ASSERT_EQ(film.counts.size(), whole.pixel_count());
    std::uint64_t counted = film.nonfinite_samples;
    for (const std::uint32_t count : film.counts) counted += count;
    EXPECT_EQ(counted, whole.pixel_count() * 8);
    EXPECT_EQ(film.channels, view.channels);
    EXPECT_EQ(film.rect, whole);
}

TEST_P(BackendContract, TheBitsDoNotDependOnTheFloatModeOfTheCaller) {
    const FilmTile expected = render(*backend, whole, {0, 2});
    const test::UnusualFloatMode unusual;
    EXPECT_TRUE(frame::identical_bits(render(*backend, whole, {0, 2}), expected));
}

TEST_P(BackendContract, ABlockIsTheMergeOfItsSingleSamplesBitForBit) {
    const FilmTile block = render(*backend, {8, 8, 16, 16}, {32, 4});
    std::vector<FilmTile> level;
    for (std::uint64_t i = 0; i < 16; ++i) level.push_back(render(*backend, {8, 8, 16, 16}, {32 + i, 0}));
    while (level.size() > 1) {
        std::vector<FilmTile> next;
        for (std::size_t i = 0; i < level.size(); i += 2) {
            frame::merge(level[i], level[i + 1]);
            next.push_back(std::move(level[i]));
        }
        level = std::move(next);
    }
    EXPECT_TRUE(frame::identical_bits(block, level[0]));
}

TEST_P(BackendContract, ThePixelsOfATileDoNotDependOnItsShape) {
    const FilmTile big = render(*backend, whole, {0, 2});
    for (const Rect part : {Rect{0, 0, 7, 5}, Rect{7, 5, 41, 27}, Rect{47, 31, 1, 1}, Rect{3, 0, 1, 32}}) {
        const FilmTile small = render(*backend, part, {0, 2});
        for (std::uint32_t plane = 0; plane < view.channels.plane_count(); ++plane) {
            for (std::int32_t y = 0; y < part.height; ++y) {
                const float* a = small.plane(plane).data() + y * part.width;
                const float* b = big.plane(plane).data() + (part.y + y) * whole.width + part.x;
                ASSERT_EQ(std::memcmp(a, b, sizeof(float) * static_cast<std::size_t>(part.width)), 0)
                    << "plane " << plane << " row " << y;
            }
        }
    }
}

TEST_P(BackendContract, AChannelHasTheSameBitsAloneAndAmongOthers) {
    const FilmTile all = render(*backend, whole, {0, 2});
    const frame::ChannelSet channels = view.channels;
    for (const frame::ChannelInfo& info : frame::channel_table()) {
        if (!channels.contains(info.channel)) continue;
        view.channels = {info.channel};
        if (info.is_derived()) view.channels.insert(frame::Channel::Radiance);
        const FilmTile alone = render(*backend, whole, {0, 2});
        const std::uint32_t first = channels.first_plane(info.channel);
        const std::uint32_t own = view.channels.first_plane(info.channel);
        for (std::uint32_t plane = 0; plane < info.plane_count(); ++plane) {
            ASSERT_EQ(std::memcmp(alone.plane(own + plane).data(), all.plane(first + plane).data(),
                                  sizeof(float) * whole.pixel_count()),
                      0)
                << info.name << " plane " << plane;
        }
    }
}

// Every view option renders whole blocks; options of light transport do not affect the geometry channels.
TEST_P(BackendContract, TransportOptionsDoNotAffectTheGeometry) {
    const FilmTile plain = render(*backend, whole, {0, 2});
    const auto expect_same_geometry = [&](const char* choice) {
        const FilmTile other = render(*backend, whole, {0, 2});
        EXPECT_EQ(other.counts, plain.counts) << choice;
        for (const frame::Channel channel :
             {frame::Channel::Depth, frame::Channel::ObjectIndex, frame::Channel::Alpha}) {
            const std::uint32_t first = view.channels.first_plane(channel);
            for (std::uint32_t plane = 0; plane < frame::info(channel).plane_count(); ++plane) {
                EXPECT_EQ(std::memcmp(other.plane(first + plane).data(), plain.plane(first + plane).data(),
                                      sizeof(float) * whole.pixel_count()),
                          0)
                    << choice << " " << frame::info(channel).name;
            }
        }
    };
    const view::View before = view;
    for (const view::PathClass kind :
         {view::PathClass::Caustics, view::PathClass::Diffuse, view::PathClass::All, view::PathClass::None}) {
        view.path_class = kind;
        expect_same_geometry("path class");
    }
    view = before;
    view.feature_rule = view::FeatureRule::Connections;
    expect_same_geometry("feature rule");
    view = before;
    view.transparent_background = true;
    expect_same_geometry("transparent background");
    view = before;
    view.renderer = view::Renderer::Whitted;
    expect_same_geometry("renderer");
}

// It renders with the renderers of its capabilities, and rejects others with the remedy.
TEST_P(BackendContract, HasTheRenderersOfItsCapabilities) {
    const view::RendererSet renderers = backend->capabilities().renderers;
    EXPECT_TRUE(renderers.contains(view::Renderer::PathTracing));
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted,
                                          view::Renderer::Raster, view::Renderer::Coverage}) {
        view.renderer = renderer;
        ++view.revision;
        if (renderers.contains(renderer)) {
            EXPECT_EQ(render(*backend, whole, {0, 1}).counts.at(0), 2u);
            EXPECT_FALSE(backend->probe(view, 20, 16, 3).empty());
            continue;
        }
        EXPECT_THROW(backend->probe(view, 20, 16, 3), Error);
        try {
            (void)backend->render(view, unit(whole, {0, 1}), {});
            ADD_FAILURE() << "rendered what it does not have: " << view::renderer_name(renderer);
        } catch (const Error& error) {
            EXPECT_EQ(error.code(), ErrorCode::Refused);
            EXPECT_NE(std::string(error.what()).find("--backend vulkan"), std::string::npos) << error.what();
        }
    }
}

TEST_P(BackendContract, AnotherSeedIsAnotherPicture) {
    const FilmTile one = render(*backend, whole, {0, 2});
    ++view.seed;
    EXPECT_FALSE(frame::identical_bits(one, render(*backend, whole, {0, 2})));
}

TEST_P(BackendContract, AStopLeavesWholeAlignedBlocks) {
    const std::uint64_t first = std::uint64_t{1} << 20;
    const SampleBlock endless{first, 20};  // would exceed the time limit of the test
    std::size_t with_blocks = 0;
    // Repeated until there are blocks: the first one may wait for its kernel.
    for (int attempt = 0; attempt < 8 || (with_blocks == 0 && attempt < 15); ++attempt) {
        std::stop_source stop;
        RenderResult result;
        {
            const std::jthread stopper([&] {
                std::this_thread::sleep_for(std::chrono::milliseconds(5 << attempt));
                stop.request_stop();
            });
            result = backend->render(view, unit({0, 0, 16, 16}, endless), stop.get_token());
        }
        ASSERT_EQ(result.status, RenderStatus::Stopped);
        std::vector<SampleBlock> blocks;
        for (const FilmTile& tile : result.blocks) blocks.push_back(tile.block);
        const std::uint64_t end = blocks.empty() ? first : blocks.back().end();
        EXPECT_EQ(blocks, frame::aligned_blocks(first, end));
        with_blocks += blocks.empty() ? 0 : 1;
        if (!result.blocks.empty()) {
            const FilmTile& last = result.blocks.back();
            EXPECT_TRUE(frame::identical_bits(last, render(*backend, last.rect, last.block)));
        }
    }
    EXPECT_GT(with_blocks, 0u);
}

TEST_P(BackendContract, AStopBeforeTheStartLeavesNothing) {
    std::stop_source stop;
    stop.request_stop();
    const RenderResult result = backend->render(view, unit(whole, {0, 4}), stop.get_token());
    EXPECT_EQ(result.status, RenderStatus::Stopped);
    EXPECT_TRUE(result.blocks.empty());
}

TEST_P(BackendContract, ManyRendersAtATimeGiveTheSameBits) {
    const FilmTile alone = render(*backend, whole, {0, 3});
    std::atomic<int> differing = 0;
    {
        std::vector<std::jthread> threads;
        for (int i = 0; i < 4; ++i) {
            threads.emplace_back([&] {
                for (int k = 0; k < 3; ++k) {
                    if (!frame::identical_bits(alone, render(*backend, whole, {0, 3}))) ++differing;
                }
            });
        }
    }
    EXPECT_EQ(differing, 0);
}

TEST_P(BackendContract, AnEditWithoutCommitLeavesTheLastGoodVersion) {
    const FilmTile before = render(*backend, whole, {0, 2});
    const Version version = backend->version();
    {
        const auto scope = backend->begin_edit();
        ASSERT_TRUE(scope->apply(builder.move(test::BlockAt, test::moved(0.2, 0, -1.5))));
        ASSERT_TRUE(scope->apply(builder.edit({scene::Remove{test::Floor}})));
    }
    EXPECT_EQ(backend->version(), version);
    EXPECT_TRUE(frame::identical_bits(before, render(*backend, whole, {0, 2})));
}

TEST_P(BackendContract, AListFromAnotherVersionIsRejected) {
    const Version version = backend->version();
    const FilmTile before = render(*backend, whole, {0, 1});
    builder.move(test::BlockAt, test::moved(0.2, 0, -1.5));  // not applied
    {
        const auto scope = backend->begin_edit();
        const auto done = scope->apply(builder.move(test::BlockAt, test::moved(0.1, 0, -1.5)));
        ASSERT_FALSE(done);
        EXPECT_EQ(done.error().code(), ErrorCode::InvalidInput);
    }
    EXPECT_EQ(backend->version(), version);
    EXPECT_TRUE(frame::identical_bits(before, render(*backend, whole, {0, 1})));
}

TEST_P(BackendContract, SeveralListsInOneEditEqualOneAtATime) {
    const auto stepwise = fresh();
    test::commit(*stepwise, {snapshot(builder.scene())});
    const std::vector<scene::ChangeList> lists{
        builder.move(test::BlockAt, test::moved(0.2, 0.1, -1.5)),
        builder.edit({test::SceneBuilder::update<scene::Light>(test::Lamp, &scene::Light::intensity, {})}),
        builder.move(test::LampAt, test::moved(0.5, 0.5, 0.5))};
    for (const scene::ChangeList& list : lists) test::commit(*stepwise, {list});
    test::commit(*backend, lists);
    EXPECT_EQ(backend->version(), stepwise->version());
    EXPECT_TRUE(frame::identical_bits(render(*backend, whole, {0, 3}), render(*stepwise, whole, {0, 3})));
}

TEST_P(BackendContract, AnEditReportCountsTheChanges) {
    const auto scope = backend->begin_edit();
    ASSERT_TRUE(scope->apply(builder.move(test::BlockAt, test::moved(0.2, 0.1, -1.5))));
    const Expected<EditReport> report = scope->commit();
    ASSERT_TRUE(report);
    EXPECT_EQ(report->entries, 1u);
    EXPECT_EQ(report->relevant, 1u);
    EXPECT_EQ(report->rebuilt, 0u);
    EXPECT_EQ(report->instances, 3u);
    EXPECT_EQ(report->triangles, 4u);
    EXPECT_TRUE(report->problems.empty());
}

TEST_P(BackendContract, AnEditWaitsForRunningRenders) {
    std::stop_source stop;
    std::atomic<bool> rendering = true;
    std::jthread renderer([&] {
        (void)backend->render(view, unit({0, 0, 16, 16}, {0, 30}), stop.get_token());
        rendering = false;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    const scene::ChangeList list = builder.move(test::BlockAt, test::moved(0.2, 0.1, -1.5));
    std::jthread stopper([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        stop.request_stop();
    });
    test::commit(*backend, {list});
    // render() may release its lock before the flag is set: allow for that moment.
    for (int i = 0; i < 1000 && rendering; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    EXPECT_FALSE(rendering);
    EXPECT_TRUE(stop.stop_requested());
    EXPECT_EQ(backend->version(), list.to);
}

TEST_P(BackendContract, AProbeReturnsALogAndDoesNotAffectTheFilm) {
    const FilmTile before = render(*backend, whole, {0, 1});
    EXPECT_FALSE(backend->probe(view, 20, 16, 3).empty());
    EXPECT_TRUE(frame::identical_bits(before, render(*backend, whole, {0, 1})));
}

TEST_P(BackendContract, AnEmptySceneRenders) {
    const auto empty = fresh();
    test::SceneBuilder empty_scene;
    test::commit(*empty, {empty_scene.edit({scene::Create{scene::RootId, scene::Root{}}})});
    const FilmTile film = render(*empty, whole, {0, 0});
    EXPECT_EQ(film.counts.at(0), 1u);
}

INSTANTIATE_TEST_SUITE_P(Catalog, BackendContract, testing::ValuesIn(BackendContract::names()),
                         [](const auto& entry) { return entry.param; });

TEST(Catalog, FindsByNameOrListsTheChoices) {
    EXPECT_EQ(find_backend("null").name, "null");
    try {
        find_backend("nul");
        FAIL() << "an unknown back-end was found";
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::InvalidInput);
        EXPECT_NE(std::string(error.what()).find("null"), std::string::npos);
    }
}

}  // namespace
}  // namespace tessera::backend

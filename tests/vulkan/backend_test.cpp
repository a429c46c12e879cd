// The Vulkan back-end: merging, failing devices, memory, cached BVHs.
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <filesystem>

#include "backends/vulkan/vulkan_backend.h"
#include "mediator/backend/catalog.h"
#include "mediator/frame/block_stack.h"
#include "tests/contract/contract_scene.h"

namespace tessera::vulkan {
namespace {

using namespace backend;
namespace fs = std::filesystem;

class Rendering {
  public:
    Rendering() : blobs(std::make_shared<scene::BlobStore>()) {
        changes = builder.edit(test::contract_scene(*blobs));
        view = test::contract_view({frame::Channel::Radiance, frame::Channel::Depth});
    }
    frame::FilmTile film(Backend& with, frame::SampleBlock block) const {
        const view::WorkUnit unit{.id = UnitId{1},
                                  .view = view.id,
                                  .revision = view.revision,
                                  .version = with.version(),
                                  .tile = view.window,
                                  .block = block};
        RenderResult result = with.render(view, unit, {});
        EXPECT_EQ(result.status, RenderStatus::Done);
        return std::move(result.blocks.at(0));
    }

    std::shared_ptr<scene::BlobStore> blobs;
    test::SceneBuilder builder;
    scene::ChangeList changes;
    view::View view;
};

std::unique_ptr<Backend> with_scene(std::unique_ptr<Backend> backend, const Rendering& rendering) {
    test::commit(*backend, {rendering.changes});
    return backend;
}

// The squares of its radiance overflow floats: merging is left to the host.
TEST(VulkanMerging, HostFallbackGivesTheSameBits) {
    Rendering rendering;
    const auto backend = with_scene(find_backend("vulkan").make({.blobs = rendering.blobs}), rendering);
    const auto dazzling = rendering.builder.edit({test::SceneBuilder::update<scene::Background>(
        test::Sky, &scene::Background::color, {.color = glm::vec3(1e25f)})});
    test::commit(*backend, {dazzling});
    const frame::FilmTile whole = rendering.film(*backend, {8, 3});
    frame::BlockStack single;
    for (std::uint64_t sample = 8; sample < 16; ++sample) single.push(rendering.film(*backend, {sample, 0}));
    EXPECT_TRUE(frame::identical_bits(whole, single.take().at(0)));
}

// Loses the device at the n-th submission, counted over all devices. Uploads are submissions too, since device
// memory is not mapped.
DeviceSettings lost_at(std::shared_ptr<std::atomic<int>> calls, int call) {
    return {.memory = {.mapping = MemorySettings::Mapping::Separate}, .fault = [=](FaultPoint point) {
                return point == FaultPoint::Submit && ++*calls == call ? VK_ERROR_DEVICE_LOST : VK_SUCCESS;
            }};
}

class VulkanBackendLost : public testing::TestWithParam<view::Renderer> {};

TEST_P(VulkanBackendLost, IsReopenedAndRendersTheSameUnit) {
    Rendering rendering;
    rendering.view.renderer = GetParam();
    const auto calls = std::make_shared<std::atomic<int>>(0);
    const auto sound = with_scene(make_backend({.blobs = rendering.blobs}, lost_at(calls, -1)), rendering);
    const int edits = *calls;
    const frame::FilmTile expected = rendering.film(*sound, {0, 2});
    ASSERT_GT(edits, 2);
    // In the middle of the edit, and at the first dispatch of the unit.
    for (const int call : {edits / 2, edits + 1}) {
        const auto again = std::make_shared<std::atomic<int>>(0);
        const auto hurt =
            with_scene(make_backend({.blobs = rendering.blobs}, lost_at(again, call)), rendering);
        const frame::FilmTile film = rendering.film(*hurt, {0, 2});
        EXPECT_GE(int(*again), call);
        EXPECT_EQ(film.planes, expected.planes) << call;
    }
}

INSTANTIATE_TEST_SUITE_P(Renderers, VulkanBackendLost,
                         testing::Values(view::Renderer::PathTracing, view::Renderer::Raster),
                         [](const auto& renderer) {
                             return std::string(view::renderer_name(renderer.param));
                         });

TEST(VulkanBackendFaults, ARepeatedlyLostDeviceIsAnErrorUntilItRecovers) {
    for (const auto mapping : {MemorySettings::Mapping::Default, MemorySettings::Mapping::Separate}) {
        Rendering rendering;
        const auto healthy = std::make_shared<std::atomic<bool>>(true);
        const auto backend = with_scene(
            make_backend({.blobs = rendering.blobs},
                         {.memory = {.mapping = mapping},
                          .fault = [=](FaultPoint) { return *healthy ? VK_SUCCESS : VK_ERROR_DEVICE_LOST; }}),
            rendering);
        const frame::FilmTile before = rendering.film(*backend, {0, 1});
        const Version version = backend->version();
        *healthy = false;
        EXPECT_THROW(rendering.film(*backend, {0, 1}), Error);
        EXPECT_THROW(rendering.film(*backend, {0, 1}), Error) << "nothing is on a device by now";
        const auto moved = rendering.builder.move(test::BlockAt, test::moved(0.2, 0.1, -1.5));
        const bool uploads_fail = mapping == MemorySettings::Mapping::Separate;
        if (uploads_fail) {
            EXPECT_THROW(test::commit(*backend, {moved}), Error);
            EXPECT_EQ(backend->version(), version);
        }
        EXPECT_FALSE(backend->capabilities().kind.empty());
        *healthy = true;
        EXPECT_EQ(rendering.film(*backend, {0, 1}).planes, before.planes);
        test::commit(*backend, {moved});
        EXPECT_NE(rendering.film(*backend, {0, 1}).planes, before.planes);
    }
}

TEST(VulkanBackendMemory, ASceneThatDoesNotFitIsRejectedAndTheLastVersionIsKept) {
    Rendering rendering;
    const auto backend = with_scene(
        make_backend({.blobs = rendering.blobs}, {.memory = {.limit = std::uint64_t{192} << 20}}), rendering);
    const frame::FilmTile before = rendering.film(*backend, {0, 0});
    const Version version = backend->version();

    scene::Geometry large = test::square(*rendering.blobs, 1.0f, test::Red);
    large.positions =
        test::array_blob<float>(*rendering.blobs, std::vector<float>(std::size_t{96} << 20));  // 384 MiB
    {
        const auto scope = backend->begin_edit();
        const auto changes = rendering.builder.edit(
            {scene::Create{ObjectId{90}, large},
             scene::Create{ObjectId{9}, test::transform(test::moved(0, 0, -4), {ObjectId{90}})},
             test::SceneBuilder::update<scene::Root>(
                 scene::RootId, &scene::Root::children,
                 {.children = {ObjectId{9}, test::FloorAt, test::BlockAt}})});
        ASSERT_TRUE(scope->apply(changes));
        const auto done = scope->commit();
        ASSERT_FALSE(done);
        EXPECT_EQ(done.error().code(), ErrorCode::OutOfMemory);
        EXPECT_NE(std::string(done.error().what()).find("is kept"), std::string::npos) << done.error().what();
    }
    EXPECT_EQ(backend->version(), version);
    EXPECT_EQ(rendering.film(*backend, {0, 0}).planes, before.planes);
}

// A wave of 12,800 triangles; animated.
scene::Geometry wave(scene::BlobStore& store, float height) {
    constexpr std::uint32_t Edge = 80;
    std::vector<float> positions;
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y <= Edge; ++y) {
        for (std::uint32_t x = 0; x <= Edge; ++x) {
            const float u = 2.4f * float(x) / Edge - 1.2f, v = 2.4f * float(y) / Edge - 1.2f;
            positions.insert(positions.end(), {u, v, height * std::sin(40.0f * u) * std::cos(50.0f * v)});
            if (x == Edge || y == Edge) continue;
            const std::uint32_t a = y * (Edge + 1) + x, above = a + Edge + 1;
            indices.insert(indices.end(), {a, a + 1, above, a + 1, above + 1, above});
        }
    }
    scene::Geometry geometry;
    geometry.hint = scene::MotionHint::Animated;
    geometry.positions = test::array_blob<float>(store, positions);
    geometry.indices = test::array_blob<std::uint32_t>(store, indices);
    return geometry;
}

class VulkanBackendTrees : public testing::Test {
  protected:
    VulkanBackendTrees() { fs::remove_all(folder); }
    ~VulkanBackendTrees() override { fs::remove_all(folder); }

    scene::ChangeList wave_of(float height) {
        return rendering.builder.edit({test::SceneBuilder::update<scene::Geometry>(
            test::Floor, {&scene::Geometry::hint, &scene::Geometry::positions, &scene::Geometry::indices},
            wave(*rendering.blobs, height))});
    }
    std::unique_ptr<Backend> start(const fs::path& cache_folder) const {
        return with_scene(make_backend({.cache_folder = cache_folder, .blobs = rendering.blobs}, {}),
                          rendering);
    }
    static EditReport report_of(Backend& backend, const scene::ChangeList& changes) {
        const auto scope = backend.begin_edit();
        EXPECT_TRUE(scope->apply(changes));
        return scope->commit().value();
    }
    std::vector<fs::path> trees() const {
        std::vector<fs::path> paths;
        for (const auto& entry : fs::directory_iterator(folder)) {
            if (entry.path().extension() == ".tree") paths.push_back(entry.path());
        }
        return paths;
    }
    const fs::path folder = fs::temp_directory_path() / ("tessera-starts-" + std::to_string(::getpid()));
    Rendering rendering;
};

TEST_F(VulkanBackendTrees, AreLoadedFromTheCache) {
    const scene::ChangeList waved = wave_of(0.1f);
    const auto without = start("");
    EXPECT_EQ(report_of(*without, waved).rebuilt, 1u);
    const frame::FilmTile expected = rendering.film(*without, {0, 1});
    const auto expect_start = [&](std::uint32_t rebuilt, std::size_t problems) {
        const auto backend = start(folder);
        const EditReport report = report_of(*backend, waved);
        EXPECT_EQ(report.rebuilt, rebuilt);
        EXPECT_EQ(report.problems.size(), problems);
        EXPECT_EQ(rendering.film(*backend, {0, 1}).planes, expected.planes);
        ASSERT_EQ(trees().size(), 1u);
    };
    expect_start(1, 0);
    expect_start(0, 0);
    fs::resize_file(trees()[0], fs::file_size(trees()[0]) / 2);
    expect_start(1, 1);
    expect_start(0, 0);
}

TEST_F(VulkanBackendTrees, AnimatedMeshesAreNotCached) {
    const scene::ChangeList low = wave_of(0.0f), higher = wave_of(0.001f), high = wave_of(50.0f);
    const auto backend = start(folder);
    EXPECT_EQ(report_of(*backend, low).rebuilt, 1u);
    EXPECT_EQ(report_of(*backend, higher).refitted, 1u);
    EXPECT_EQ(report_of(*backend, high).rebuilt, 1u) << "too far for the tree of before";
    EXPECT_EQ(trees().size(), 1u);
}

}  // namespace
}  // namespace tessera::vulkan

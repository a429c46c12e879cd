// Images, pipelines that draw, and the order that barriers keep between drawing, kernels and copies.
#include <algorithm>
#include <array>
#include <optional>
#include <random>

#include "backends/vulkan/device/graphics_pipeline.h"
#include "backends/vulkan/device/image.h"
#include "tests/vulkan/add.comp.h"
#include "tests/vulkan/quads.frag.h"
#include "tests/vulkan/quads.vert.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

constexpr std::uint32_t Edge = 64;  // of the images and the viewport

struct Quad {
    float x, y, size, depth;
};
using Ids = std::array<std::uint32_t, 2>;
constexpr Ids Nothing{0xffffffffu, 0};

// The quad that covers the pixels [x, x + size) x [y, y + size).
Quad pixels(std::uint32_t x, std::uint32_t y, std::uint32_t size, float depth) {
    const auto ndc = [](std::uint32_t pixel) { return 2.0f * float(pixel) / float(Edge) - 1.0f; };
    return {ndc(x), ndc(y), 2.0f * float(size) / float(Edge), depth};
}

class DrawingTest : public VulkanTest {
  protected:
    void SetUp() override {
        VulkanTest::SetUp();
        ASSERT_TRUE(device().info().draws) << "the device has no graphics";
    }
    GraphicsPipeline quads() {
        return {device(),
                {.name = "quads",
                 .vertex = shaders::quads_vert(),
                 .fragment = shaders::quads_frag(),
                 .push_bytes = sizeof(VkDeviceAddress)}};
    }
    // One draw for each instance, as a call of `per_call` draws wants it.
    Buffer draws(std::uint32_t count, std::uint32_t per_call) {
        std::vector<VkDrawIndirectCommand> list;
        for (std::uint32_t i = 0; i < count; ++i) list.push_back({6, 1, 0, i % per_call});
        return make_buffer(device(), list);
    }
    std::vector<Ids> read(const Image& ids, const Rect& area) {
        const Buffer to(device(), std::uint64_t(area.pixel_count()) * 8);
        device().queue().submit(CopyImage{&ids, area, &to, 0});
        return download<Ids>(device(), to);
    }
    static constexpr Rect Whole{0, 0, Edge, Edge};
};

// Random quads at few depths, so that many are as near as others: the last of the nearest is seen.
TEST_F(DrawingTest, TheLastOfEquallyNearTrianglesWins) {
    const GraphicsPipeline pipeline = quads();
    std::mt19937 random(3);
    constexpr std::uint32_t Count = 40;
    std::vector<Quad> list;
    std::vector<Ids> expected(Edge * Edge, Nothing);
    std::vector<float> nearest(Edge * Edge, 0.0f);
    for (std::uint32_t i = 0; i < Count; ++i) {
        const std::uint32_t x = random() % Edge, y = random() % Edge, size = 1 + random() % 24;
        const float depth = 0.25f * float(1 + random() % 3);
        list.push_back(pixels(x, y, size, depth));
        for (std::uint32_t py = y; py < std::min(Edge, y + size); ++py) {
            for (std::uint32_t px = x; px < std::min(Edge, x + size); ++px) {
                const std::size_t at = py * Edge + px;
                if (depth < nearest[at]) continue;
                nearest[at] = depth;
                // Pixel centres on the diagonal are on the edge of both triangles: either one may win.
                expected[at] = {i, (px - x) + (py - y) + 1 == size ? 2u : (px - x) + (py - y) >= size};
            }
        }
    }
    const Buffer data = make_buffer(device(), list);
    const Image ids(device(), Image::Kind::Ids, Edge, Edge), depth(device(), Image::Kind::Depth, Edge, Edge);
    for (const std::uint32_t per_call : {1u, 7u, 64u}) {
        if (per_call > device().info().draws_per_call) continue;
        const Buffer commands = draws(Count, per_call);
        device().queue().submit(DrawList{.pipeline = &pipeline,
                                         .arguments = data.address(),
                                         .ids = &ids,
                                         .depth = &depth,
                                         .area = Whole,
                                         .viewport = Edge,
                                         .draws = &commands,
                                         .count = Count,
                                         .per_call = per_call});
        std::vector<Ids> seen = read(ids, Whole);
        for (std::size_t at = 0; at < seen.size(); ++at) {
            if (expected[at][1] == 2) seen[at][1] = 2;
        }
        ASSERT_EQ(seen, expected) << per_call;
    }
}

TEST_F(DrawingTest, DrawsTouchOnlyTheAreaAndCanKeepDepth) {
    const GraphicsPipeline pipeline = quads();
    const Buffer near = make_buffer(device(), std::vector<Quad>{pixels(0, 0, 32, 0.75f)});
    const Buffer far = make_buffer(device(), std::vector<Quad>{pixels(0, 0, 64, 0.5f)});
    const Buffer one = draws(1, 1);
    const Image ids(device(), Image::Kind::Ids, Edge, Edge), depth(device(), Image::Kind::Depth, Edge, Edge);
    const DrawList first{.pipeline = &pipeline,
                         .arguments = near.address(),
                         .ids = &ids,
                         .depth = &depth,
                         .area = Whole,
                         .viewport = Edge,
                         .draws = &one,
                         .count = 1};
    DrawList second = first;
    second.arguments = far.address();
    second.depth_before = DrawList::Depth::Keep;
    device().queue().submit(first);
    device().queue().submit(second);
    const std::vector<Ids> seen = read(ids, Whole);
    EXPECT_EQ(seen[10 * Edge + 10], Nothing) << "behind what was drawn first";
    EXPECT_EQ(seen[40 * Edge + 10][0], 0u);

    second.depth_before = DrawList::Depth::Clear;
    second.area = {8, 4, 10, 6};
    device().queue().submit(second);
    const std::vector<Ids> part = read(ids, {6, 2, 14, 10});
    for (std::int32_t y = 0; y < 10; ++y) {
        for (std::int32_t x = 0; x < 14; ++x) {
            const bool inside = second.area.contains(6 + x, 2 + y);
            ASSERT_EQ(part[std::size_t(y) * 14 + std::size_t(x)][0], inside ? 0u : Nothing[0])
                << x << " " << y;
        }
    }
    const Buffer depths(device(), Edge * Edge * 4);
    device().queue().submit(CopyImage{&depth, Whole, &depths, 0});
    const std::vector<float> kept = download<float>(device(), depths);
    EXPECT_EQ(kept[5 * Edge + 9], 0.5f);
    EXPECT_EQ(kept[20 * Edge + 9], 0.75f);
    EXPECT_EQ(kept[20 * Edge + 50], 0.5f);
}

// Kernels write what is drawn and read what was drawn, repeatedly in the same memory.
TEST_F(DrawingTest, DrawsAndKernelsKeepTheirOrder) {
    struct Add {
        std::uint64_t a, b, to;
        std::uint32_t count, summand;
    };
    const ComputePipeline adder(device(),
                                {.name = "add", .code = shaders::add_comp(), .push_bytes = sizeof(Add)});
    const GraphicsPipeline pipeline = quads();
    const Image ids(device(), Image::Kind::Ids, Edge, Edge), depth(device(), Image::Kind::Depth, Edge, Edge);
    constexpr std::uint32_t Words = Edge * Edge * 2;
    const Buffer zeros = make_buffer(device(), std::vector<std::uint32_t>(Words));
    const Buffer commands(device(), 16), picture(device(), Words * 4), sum(device(), Words * 4);
    const Buffer data = make_buffer(device(), std::vector<Quad>(4, pixels(0, 0, Edge, 0.5f)));
    const VkDrawIndirectCommand start{6, 1, 0, 0};
    std::vector<Step> steps{Fill{&sum, 0, Words * 4, 0}};
    for (const std::uint32_t word : {6u, 1u, 0u, 0u}) {
        steps.push_back(Fill{&commands, 4 * (steps.size() - 1), 4, word});
    }
    // Odd turns draw no instance, which the kernel before writes into the list.
    for (std::uint32_t turn = 0; turn < 6; ++turn) {
        steps.push_back(Fill{&commands, 4, 4, turn % 2 == 0 ? start.instanceCount : 0u});
        steps.push_back(DrawList{.pipeline = &pipeline,
                                 .arguments = data.address(),
                                 .ids = &ids,
                                 .depth = &depth,
                                 .area = Whole,
                                 .viewport = Edge,
                                 .draws = &commands,
                                 .count = 1,
                                 .reads = {&data}});
        steps.push_back(CopyImage{&ids, Whole, &picture, 0});
        steps.push_back(Dispatch{.pipeline = &adder,
                                 .arguments = Add{sum.address(), picture.address(), sum.address(), Words, 0},
                                 .groups = {Words / 64},
                                 .reads = {&picture},
                                 .writes = {&sum}});
    }
    device().queue().submit(steps);
    const std::vector<std::uint32_t> found = download<std::uint32_t>(device(), sum);
    for (std::size_t pixel = 0; pixel < found.size() / 2; ++pixel) {
        ASSERT_EQ(found[2 * pixel], std::uint32_t(0) - 3u) << "three turns without an instance, of " << pixel;
    }
}

TEST_F(DrawingTest, RejectsInvalidDraws) {
    const GraphicsPipeline pipeline = quads();
    const Image ids(device(), Image::Kind::Ids, Edge, Edge), depth(device(), Image::Kind::Depth, Edge, Edge);
    const Buffer one = draws(1, 1), data = make_buffer(device(), std::vector<Quad>(1));
    const DrawList good{.pipeline = &pipeline,
                        .arguments = data.address(),
                        .ids = &ids,
                        .depth = &depth,
                        .area = Whole,
                        .viewport = Edge,
                        .draws = &one,
                        .count = 1};
    EXPECT_NO_THROW(device().queue().submit(good).wait());
    const auto refused = [&](auto change) {
        DrawList bad = good;
        change(bad);
        EXPECT_THROW(device().queue().submit(bad), Error);
    };
    refused([](DrawList& list) { list.ids = nullptr; });
    refused([&](DrawList& list) { list.ids = &depth; });
    refused([](DrawList& list) { list.area.width = Edge + 1; });
    refused([](DrawList& list) { list.area.x = -1; });
    refused([](DrawList& list) { list.count = 2; });
    refused([](DrawList& list) { list.per_call = 0; });
    refused([](DrawList& list) { list.viewport = 0; });
    refused([](DrawList& list) { list.arguments = std::uint32_t{0}; });
    EXPECT_THROW(Image(device(), Image::Kind::Ids, 0, 4), Error);
    EXPECT_THROW(Image(device(), Image::Kind::Ids, device().info().image_edge + 1, 4), Error);
    EXPECT_THROW(device().queue().submit(CopyImage{&ids, Whole, &one, 0}), Error);
}

// Images between buffers of one block, made and dropped while others live.
TEST_F(DrawingTest, ImagesAndBuffersShareMemoryAndKeepTheirContents) {
    const GraphicsPipeline pipeline = quads();
    const Buffer one = draws(1, 1), data = make_buffer(device(), std::vector<Quad>{pixels(0, 0, Edge, 0.5f)});
    std::mt19937 random(4);
    std::vector<std::pair<Buffer, std::uint32_t>> buffers;
    std::optional<Image> kept;
    for (std::uint32_t turn = 0; turn < 30; ++turn) {
        Image ids(device(), Image::Kind::Ids, Edge, Edge), depth(device(), Image::Kind::Depth, Edge, Edge);
        Buffer buffer(device(), 4 * (1 + random() % 5000));
        device().queue().submit(Fill{&buffer, 0, buffer.size(), turn});
        device().queue().submit(DrawList{.pipeline = &pipeline,
                                         .arguments = data.address(),
                                         .ids = &ids,
                                         .depth = &depth,
                                         .area = Whole,
                                         .viewport = Edge,
                                         .draws = &one,
                                         .count = 1});
        buffers.emplace_back(std::move(buffer), turn);
        if (turn == 7) kept = std::move(ids);
    }
    for (const Ids& seen : read(*kept, Whole)) ASSERT_EQ(seen[0], 0u);
    for (const auto& [buffer, mark] : buffers) {
        ASSERT_EQ(download<std::uint32_t>(device(), buffer),
                  std::vector<std::uint32_t>(buffer.size() / 4, mark));
    }
}

}  // namespace

}  // namespace tessera::vulkan

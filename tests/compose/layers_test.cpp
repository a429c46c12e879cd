// Compositing by depth and alpha.
#include "master/render/compose/layers.h"

#include <gtest/gtest.h>

#include "mediator/base/error.h"
#include "tests/compose/stack.h"

namespace tessera::test {
namespace {

const Pixel Red{{1.0f, 0.0f, 0.0f}, 1.0f, 2.0f};
const Pixel GreenGlass{{0.0f, 0.5f, 0.0f}, 0.5f, 1.0f};  // premultiplied
const Pixel Blue{{0.0f, 0.0f, 1.0f}, 1.0f, 3.0f};
const Pixel Nothing{};
const Pixel Sky{{0.25f, 0.5f, 0.75f}, 0.0f, Infinity};  // emits, and covers nothing

TEST(Compose, NearestLayerIsOnTopInAnyOrder) {
    EXPECT_EQ(composed({Red, GreenGlass}), (Rgba{0.5f, 0.5f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({GreenGlass, Red}), (Rgba{0.5f, 0.5f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({Blue, GreenGlass, Red}), (Rgba{0.5f, 0.5f, 0.0f, 1.0f}));
    Pixel far_glass = GreenGlass;
    far_glass.depth = 2.5f;
    EXPECT_EQ(composed({far_glass, Red, Blue}), (Rgba{1.0f, 0.0f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({Blue, far_glass}), (Rgba{0.0f, 0.5f, 0.5f, 1.0f}));
}

TEST(Compose, LaterLayerWinsAtEqualDepth) {
    Pixel red = Red, blue = Blue, glass = GreenGlass;
    red.depth = blue.depth = glass.depth = 7.0f;
    EXPECT_EQ(composed({red, blue}), (Rgba{0.0f, 0.0f, 1.0f, 1.0f}));
    EXPECT_EQ(composed({blue, red}), (Rgba{1.0f, 0.0f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({blue, red, glass}), (Rgba{0.5f, 0.5f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({glass, blue, red}), (Rgba{1.0f, 0.0f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({blue, glass, red, Nothing, glass}), (Rgba{0.5f, 0.5f, 0.0f, 1.0f}));
}

TEST(Compose, TransparentPixelsShowTheLayerBehind) {
    EXPECT_EQ(composed({Nothing, Nothing}), (Rgba{0.0f, 0.0f, 0.0f, 0.0f}));
    EXPECT_EQ(composed({Red, Nothing}), (Rgba{1.0f, 0.0f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({Sky, GreenGlass}), (Rgba{0.125f, 0.75f, 0.375f, 0.5f}));
    EXPECT_EQ(composed({Sky, Red, Nothing}), (Rgba{1.0f, 0.0f, 0.0f, 1.0f}));
    EXPECT_EQ(composed({Nothing, Sky}), (Rgba{0.25f, 0.5f, 0.75f, 0.0f}));
}

// Against the definition, one pixel at a time; a size that no block divides.
TEST(Compose, PixelsAreIndependent) {
    constexpr std::uint32_t Width = 333, Height = 77;
    Stack stack(Width, Height, 2);
    const auto left = [](std::size_t i) {
        return Pixel{{0.5f, float(i % 7), 0.0f}, 0.5f, float(i * 7 % 13)};
    };
    const auto right = [](std::size_t i) {
        return Pixel{{float(i % 5), 0.0f, 0.25f}, 0.25f, float(i * 5 % 13)};
    };
    for (std::size_t i = 0; i < stack.pixels(); ++i) {
        stack.put(0, i, left(i));
        stack.put(1, i, right(i));
    }
    const filter::Planes out = stack.composed();
    ASSERT_EQ(out.components(), 4u);
    for (std::size_t i = 0; i < stack.pixels(); ++i) {
        const Rgba expected = composed({left(i), right(i)});
        for (std::uint32_t c = 0; c < 4; ++c) ASSERT_EQ(out.plane(c)[i], expected[c]) << i;
        const bool second_first = right(i).depth <= left(i).depth;
        const Pixel front = second_first ? right(i) : left(i), back = second_first ? left(i) : right(i);
        ASSERT_EQ(expected[0], front.color[0] + (1.0f - front.alpha) * back.color[0]) << i;
    }
}

TEST(Compose, ReusesMemory) {
    Stack stack(64, 64, 2);
    tbb::task_arena arena(2);
    filter::Planes out;
    master::compose(stack.layers(), 64, 64, out, arena);
    const float* memory = out.values().data();
    master::compose(stack.layers(), 64, 64, out, arena);
    EXPECT_EQ(out.values().data(), memory);
}

TEST(Compose, RejectsMismatchedSizes) {
    tbb::task_arena arena(1);
    filter::Planes out;
    const Stack stack(8, 8, 1), many(8, 8, master::MaxLayers + 1);
    EXPECT_THROW(master::compose({}, 8, 8, out, arena), Error);
    EXPECT_THROW(master::compose(stack.layers(), 8, 9, out, arena), Error);
    EXPECT_THROW(master::compose(many.layers(), 8, 8, out, arena), Error);
    auto layers = stack.layers();
    layers[0].depth = layers[0].depth.first(63);
    EXPECT_THROW(master::compose(layers, 8, 8, out, arena), Error);
}

}  // namespace
}  // namespace tessera::test

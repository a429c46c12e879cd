// Compositing of extreme values.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>

#include "mediator/base/random.h"
#include "tests/compose/stack.h"

namespace tessera::test {
namespace {

constexpr float Largest = std::numeric_limits<float>::max();
constexpr float Tiny = std::numeric_limits<float>::denorm_min();

void expect_same_bits(const Rgba& found, const Pixel& pixel) {
    const Rgba expected{pixel.color[0], pixel.color[1], pixel.color[2], pixel.alpha};
    for (std::size_t c = 0; c < 4; ++c) {
        EXPECT_EQ(std::bit_cast<std::uint32_t>(found[c]), std::bit_cast<std::uint32_t>(expected[c])) << c;
    }
}

const std::vector<std::array<float, 3>> HardColors{
    {0.1f, 1.0f / 3.0f, -0.0f}, {Largest, -Largest, Tiny}, {-Tiny, 0.0f, 1e-40f}};

TEST(ComposeNumerics, SingleLayerIsBitIdentical) {
    for (const auto& color : HardColors) {
        for (const float alpha : {1.0f, 0.0f, 0.3f, Tiny}) {
            for (const float depth : {0.0f, -1.0f, 5.0f, Infinity, -Infinity, std::nanf("")}) {
                const Pixel pixel{color, alpha, depth};
                expect_same_bits(composed({pixel}), pixel);
            }
        }
    }
}

// Not even the sign of a zero or a NaN comes through from behind.
TEST(ComposeNumerics, OpaqueFrontLayerIsBitIdentical) {
    for (const auto& color : HardColors) {
        const Pixel front{color, 1.0f, 1.0f};
        for (const Pixel& behind :
             {Pixel{{0.0f, 0.0f, 0.0f}, 0.0f, Infinity}, Pixel{{Largest, Largest, Largest}, 1.0f, 2.0f},
              Pixel{{Infinity, -Infinity, std::nanf("")}, 1.0f, 2.0f}}) {
            expect_same_bits(composed({front, behind}), front);
            expect_same_bits(composed({behind, front}), front);
        }
    }
}

TEST(ComposeNumerics, FiniteInputGivesFiniteOutput) {
    const std::array values{0.0f,    -0.0f,    1.0f, -1.0f,  1e30f,       -1e30f,
                            Largest, -Largest, Tiny, 1e-38f, Largest / 2, 0.999999940395f};
    const std::array depths{0.0f, -0.0f, 1.0f, Largest, -Largest, Infinity, -Infinity, std::nanf(""), Tiny};
    CounterRandom random(11);
    for (int turn = 0; turn < 3000; ++turn) {
        std::vector<Pixel> pixels(1 + random.below(5));
        for (Pixel& pixel : pixels) {
            for (float& c : pixel.color) c = values[random.below(values.size())];
            pixel.alpha = std::abs(values[random.below(values.size())]);
            pixel.depth = depths[random.below(depths.size())];
        }
        for (const float value : composed(pixels)) ASSERT_TRUE(std::isfinite(value)) << turn;
        ASSERT_LE(composed(pixels)[3], 1.0f + 1e-6f) << "alpha, turn " << turn;
    }
}

// Against the sum in double, sorted by the standard library. Every layer rounds its product, its sum and its
// transmittance once, each by u = 2^-24 of what is at most the result for light that is not negative: 3 u a
// layer.
TEST(ComposeNumerics, EqualsFrontToBackSum) {
    CounterRandom random(12);
    for (int turn = 0; turn < 2000; ++turn) {
        std::vector<Pixel> pixels(2 + random.below(7));
        for (Pixel& pixel : pixels) {
            for (float& c : pixel.color) c = static_cast<float>(random.uniform());
            pixel.alpha = static_cast<float>(random.uniform());
            pixel.depth = static_cast<float>(random.below(6));  // ties are many
        }
        std::vector<Pixel> sorted(pixels.rbegin(), pixels.rend());
        std::stable_sort(sorted.begin(), sorted.end(),
                         [](const Pixel& a, const Pixel& b) { return a.depth < b.depth; });
        double seen_through = 1.0, red = 0.0, alpha = 0.0;
        for (const Pixel& pixel : sorted) {
            red += seen_through * double(pixel.color[0]);
            alpha += seen_through * double(pixel.alpha);
            seen_through *= 1.0 - double(pixel.alpha);
        }
        const double bound = 3.0 * std::ldexp(1.0, -24) * static_cast<double>(pixels.size());
        const Rgba found = composed(pixels);
        ASSERT_NEAR(found[0], red, bound * red) << turn;
        ASSERT_NEAR(found[3], alpha, bound * alpha) << turn;
    }
}

}  // namespace
}  // namespace tessera::test

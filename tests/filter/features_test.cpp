// The inputs of windowed filters: guides, demodulated light, and holes filled from the nearest pixel.
#include "master/filter/features.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mediator/base/random.h"
#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

class FeaturesTest : public testing::Test {
  protected:
    tbb::task_arena arena{2};
    RunContext context{arena, {}};
    Features features;
};

TEST_F(FeaturesTest, AHoleTakesFromTheNearestPixelWithSamples) {
    constexpr std::uint32_t Width = 40, Height = 30;
    const auto is_hole = [](auto x, auto y) { return mix(x + 1000 * y) % 10 != 0; };
    // Every pixel has its own index as its radiance, to identify where a value comes from.
    const Inputs inputs = synthetic_inputs(Width, Height, 1, [&](auto x, auto y, auto) {
        SyntheticSample s;
        s.high[0] = is_hole(x, y) ? NAN : static_cast<float>(x + Width * y);
        return s;
    });
    ASSERT_TRUE(features.prepare(inputs, false, context));
    std::uint32_t farther = 0;
    for (std::uint32_t y = 0; y < Height; ++y) {
        for (std::uint32_t x = 0; x < Width; ++x) {
            const auto squared = [&](std::uint32_t u, std::uint32_t v) {
                const double du = double(u) - x, dv = double(v) - y;
                return du * du + dv * dv;
            };
            double nearest = 1e30;
            for (std::uint32_t v = 0; v < Height; ++v) {
                for (std::uint32_t u = 0; u < Width; ++u) {
                    if (!is_hole(u, v)) nearest = std::min(nearest, squared(u, v));
                }
            }
            const auto source = static_cast<std::uint32_t>(features.color().row(0, y)[x]);
            ASSERT_FALSE(is_hole(source % Width, source / Width)) << x << ", " << y;
            farther += squared(source % Width, source / Width) > nearest ? 1u : 0u;
            EXPECT_EQ(features.known().row(0, y)[x], is_hole(x, y) ? 0.0f : 1.0f);
        }
    }
    EXPECT_LE(farther, Width * Height / 100);  // the sweeps miss few
}

TEST_F(FeaturesTest, RemodulationRestoresThePicture) {
    const Inputs inputs = synthetic_inputs(32, 24, 2, [](auto x, auto y, auto i) {
        SyntheticSample s = shadowed_texture(32, 24, x, y, i);
        if (x < 8) s.albedo = {0.0f, 0.005f, 0.8f};
        s.alpha = x % 3 == 0 ? 0.0f : 1.0f;
        return s;
    });
    ASSERT_TRUE(features.prepare(inputs, true, context));
    EXPECT_EQ(features.albedo().row(0, 5)[3], 1.0f);  // too dark to divide by
    EXPECT_EQ(features.albedo().row(1, 5)[3], 1.0f);
    EXPECT_EQ(features.albedo().row(2, 5)[3], 0.8f);
    Planes picture = features.color();
    for (std::uint32_t y = 0; y < 24; ++y) features.finish_row(picture, y);
    for (std::uint32_t c = 0; c < 4; ++c) {
        for (std::size_t i = 0; i < picture.pixel_count(); ++i) {
            EXPECT_NEAR(picture.plane(c)[i], inputs.color(c)[i], 1e-6f);
        }
    }
}

TEST_F(FeaturesTest, DepthGuidesSeparateMisses) {
    const Inputs inputs = synthetic_inputs(4, 1, 1, [](auto x, auto, auto) {
        SyntheticSample s;
        s.depth = std::array{1.0f, 2.0f, 4.0f, std::numeric_limits<float>::infinity()}[x];
        return s;
    });
    ASSERT_TRUE(features.prepare(inputs, false, context));
    Planes guides;
    ASSERT_TRUE(features.guides(inputs, DepthGuide::Logarithm, {1.0f, 1.0f, 10.0f}, guides, context));
    const float* depth = guides.row(6, 0);
    EXPECT_NEAR(depth[1] - depth[0], 10.0 * std::log(2.0), 1e-5);
    EXPECT_NEAR(depth[2] - depth[1], 10.0 * std::log(2.0), 1e-5);
    EXPECT_GT(depth[3] - depth[2], 1000.0f);
    ASSERT_TRUE(features.guides(inputs, DepthGuide::Disparity, {1.0f, 1.0f, 1.0f}, guides, context));
    EXPECT_NEAR(depth[0], 12.0 / 7.0, 1e-6);  // of the mean disparity (1 + 1/2 + 1/4) / 3
    EXPECT_NEAR(depth[2], 3.0 / 7.0, 1e-6);
    EXPECT_EQ(depth[3], 0.0f);
}

}  // namespace
}  // namespace tessera::filter

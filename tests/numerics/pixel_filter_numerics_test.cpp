// The pixel filter at extreme inputs: widths, radiances, depths, sample counts.
#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/filter/pixel_pictures.h"

namespace tessera::filter {
namespace {

constexpr float Infinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t Width = 37, Height = 29;  // no multiple of a vector

const std::array<std::string, 6> Methods{"pixel",
                                         "pixel:adaptive=off",
                                         "pixel:method=brute",
                                         "pixel:method=atrous",
                                         "pixel:normals=on,root=simple,aa_recovery=off",
                                         "pixel:t=0.000001,spike_clamp=0"};

void expect_finite(const std::function<PixelLight(std::uint32_t, std::uint32_t)>& light) {
    const Inputs inputs = pixel_inputs(Width, Height, light);
    for (const std::string& choice : Methods) {
        const Output out = run_filter(choice, inputs, true);
        for (const float value : out.picture.values()) ASSERT_TRUE(std::isfinite(value)) << choice;
        for (const float s : out.maps[3].planes.values()) {
            ASSERT_GE(s, 0.0f) << choice;
            ASSERT_LE(s, 1.0f) << choice;
        }
    }
}

TEST(PixelNumerics, ConstantLightIsPreservedForAnySampleCounts) {
    for (const float light : {1e-30f, 1e-3f, 1.0f, 1e6f, 1e25f}) {
        for (const float variance : {0.0f, 1e-4f, 0.1f, 10.0f}) {
            const Inputs inputs = pixel_inputs(Width, Height, [&](std::uint32_t x, std::uint32_t y) {
                const float n = std::floor(6.0f * noise(1, x, y));
                PixelLight p{.high = light,
                             .variance = variance * light * light,
                             .headlight = noise(2, x, y),
                             .n = n,
                             .low = 0.5f * light};
                if (n == 0.0f) p = {.headlight = 0.0f, .depth = Infinity, .n = 0.0f, .alpha = 0.0f};
                if (n < 2.0f) p.variance = 0.0f;
                return p;
            });
            for (const std::string& choice : Methods) {
                const Output out = run_filter(choice, inputs);
                for (std::uint32_t c = 0; c < 3; ++c) {
                    for (const float value : out.picture.plane(c))
                        ASSERT_NEAR(value / (1.5f * light), 1.0, 1e-6) << choice;
                }
                for (const float alpha : out.picture.plane(3)) ASSERT_NEAR(alpha, 1.0, 1e-6) << choice;
            }
        }
    }
}

TEST(PixelNumerics, NoSamples) {
    expect_finite([](std::uint32_t, std::uint32_t) {
        return PixelLight{.headlight = 0.0f, .depth = Infinity, .n = 0.0f, .alpha = 0.0f};
    });
    expect_finite(
        [](std::uint32_t, std::uint32_t) { return PixelLight{.headlight = 0.0f, .depth = Infinity}; });
}

TEST(PixelNumerics, OneOrTwoSamples) {
    for (const float n : {1.0f, 2.0f}) {
        expect_finite([n](std::uint32_t x, std::uint32_t y) {
            return PixelLight{.high = noise(1, x, y), .variance = n < 2.0f ? 0.0f : 0.3f, .n = n};
        });
    }
    // A single sample gives no variance: the pixel shows the filtered light.
    const Inputs inputs = pixel_inputs(Width, Height, [](std::uint32_t x, std::uint32_t y) {
        return PixelLight{.high = noise(1, x, y) < 0.3f ? 1.0f : 0.0f, .n = 1.0f};
    });
    const Output out = run_filter("pixel", inputs, true);
    for (const float s : out.maps[3].planes.values()) EXPECT_EQ(s, 0.0f);
    EXPECT_NEAR(out.picture.row(0, 14)[18], 0.3f, 0.15f);
}

TEST(PixelNumerics, HugeDynamicRange) {
    expect_finite([](std::uint32_t x, std::uint32_t y) {
        const float exponent = 60.0f * noise(1, x, y) - 30.0f;
        const float light = std::pow(10.0f, exponent);
        return PixelLight{.high = light, .variance = std::min(1e36f, light * light), .low = 1.0f / light};
    });
    expect_finite([](std::uint32_t x, std::uint32_t y) {
        return PixelLight{.high = noise(1, x, y) < 0.02f ? 3e38f : 0.0f, .variance = 3e38f};
    });
}

TEST(PixelNumerics, Denormals) {
    expect_finite([](std::uint32_t x, std::uint32_t y) {
        return PixelLight{
            .high = 1e-40f * noise(1, x, y), .variance = 1e-44f, .headlight = 1e-42f, .depth = 1e-41f};
    });
}

TEST(PixelNumerics, DepthsOfEveryScale) {
    for (const float depth : {1e-20f, 1.0f, 1e10f, 1e30f, 3e38f}) {
        expect_finite([depth](std::uint32_t x, std::uint32_t y) {
            const float d = noise(2, x, y) < 0.3f ? Infinity : depth * (1.0f + noise(3, x, y));
            return PixelLight{.high = noise(1, x, y),
                              .variance = 0.1f,
                              .depth = std::isinf(d) && noise(2, x, y) >= 0.3f ? depth : d};
        });
    }
}

TEST(PixelNumerics, WindowsThatRejectEverything) {
    // All pixels are dissimilar: the output equals the input.
    const Inputs inputs = pixel_inputs(Width, Height, [](std::uint32_t x, std::uint32_t y) {
        return PixelLight{.high = noise(1, x, y), .variance = 1.0f, .headlight = float(x + Width * y)};
    });
    for (const std::string& choice : {std::string("pixel:aa_recovery=off"), std::string("pixel:method=brute"),
                                      std::string("pixel:method=atrous")}) {
        const Output out = run_filter(choice, inputs);
        for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
            EXPECT_NEAR(out.picture.plane(0)[i], inputs.color(0)[i], 1e-6f) << choice;
        }
    }
}

TEST(PixelNumerics, EveryRangeOfEveryParameter) {
    const Inputs inputs = pixel_inputs(Width, Height, [](std::uint32_t x, std::uint32_t y) {
        return PixelLight{.high = noise(1, x, y), .variance = 0.2f, .headlight = noise(4, x / 5, y / 5)};
    });
    for (const char* choice : {"pixel:t=10",
                               "pixel:t=0.000001",
                               "pixel:sigma_s=0.5",
                               "pixel:sigma_s=32",
                               "pixel:sigma_s=32,method=brute",
                               "pixel:sigma_s=0.5,method=brute,adaptive=off",
                               "pixel:sigma_s=0.5,method=atrous",
                               "pixel:sigma_s=32,method=atrous",
                               "pixel:sigma_c=0.0001",
                               "pixel:sigma_c=10",
                               "pixel:sigma_d=0.000001",
                               "pixel:sigma_d=1000000000",
                               "pixel:normals=on,sigma_n=0.001",
                               "pixel:iterations=1",
                               "pixel:iterations=5",
                               "pixel:adaptive_clamp=1",
                               "pixel:adaptive_clamp=64",
                               "pixel:adaptive_clamp=64,t=0.000001",
                               "pixel:spike_clamp=0",
                               "pixel:spike_clamp=1000000"}) {
        const Output out = run_filter(choice, inputs);
        for (const float value : out.picture.values()) {
            ASSERT_GE(value, 0.0f) << choice;
            ASSERT_LE(value, 1.0001f) << choice;
        }
    }
}

TEST(PixelNumerics, PicturesOfFewPixels) {
    for (const std::uint32_t width : {1u, 2u, 7u, 8u, 9u, 33u}) {
        for (const std::uint32_t height : {1u, 2u, 130u}) {
            const Inputs inputs = pixel_inputs(width, height, [](std::uint32_t x, std::uint32_t y) {
                return PixelLight{.high = noise(1, x, y), .variance = 0.3f, .headlight = noise(2, x, y)};
            });
            for (const std::string& choice : Methods) {
                const std::string without = choice + (choice == "pixel" ? ":" : ",") + "blend=off";
                const Output out = run_filter(choice, inputs), mean = run_filter(without, inputs);
                for (std::size_t i = 0; i < inputs.pixel_count(); ++i) {
                    ASSERT_GE(mean.picture.plane(0)[i], 0.0f);
                    ASSERT_LE(mean.picture.plane(0)[i], 1.0001f);
                    // The blend adds bands of what was removed, each with a weight of its own: no mean.
                    ASSERT_GE(out.picture.plane(0)[i], 0.0f);
                    ASSERT_LE(out.picture.plane(0)[i], 1.02f);
                }
            }
        }
    }
}

}  // namespace
}  // namespace tessera::filter

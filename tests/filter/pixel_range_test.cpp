// Which light the pixel filter smooths, and how it compares pixels (Schwenk 3.6.2).
#include <gtest/gtest.h>

#include <cmath>

#include "master/filter/catalog.h"
#include "mediator/filter/choice.h"
#include "tests/filter/pixel_pictures.h"

namespace tessera::filter {
namespace {

using frame::Channel;

// Largest change of the left half, which is black, by the right one, which is lit.
double leak_into_dark(const std::string& options, const PixelLight& left, const PixelLight& right) {
    const Inputs inputs = pixel_inputs(64, 32, [&](std::uint32_t x, std::uint32_t) {
        PixelLight light = x < 32 ? left : right;
        light.high = x < 32 ? 0.0f : 1.0f;
        light.variance = 1.0f;
        return light;
    });
    const Output out = run_filter(FilteredLight + options, inputs);
    double worst = 0.0;
    for (std::uint32_t y = 0; y < 32; ++y) {
        for (std::uint32_t x = 0; x < 32; ++x) worst = std::max(worst, double(out.picture.row(1, y)[x]));
    }
    return worst;
}

// Grey of 0.002 and 0.01 has L* of 1.8 and 9, and is closer in linear RGB than 0.81 and 0.9, of 92.1 and 96.
TEST(PixelRange, LabToleratesLessInTheDarkThanLinearColour) {
    const PixelLight black{.headlight = 0.002f}, dark{.headlight = 0.01f};
    const PixelLight bright{.headlight = 0.81f}, white{.headlight = 0.9f};
    EXPECT_GT(leak_into_dark("", black, dark), 0.1);
    EXPECT_LT(leak_into_dark("", bright, white), 1e-5);
    EXPECT_LT(leak_into_dark(",color_metric=lab", black, dark), 0.01);
    EXPECT_GT(leak_into_dark(",color_metric=lab", bright, white), 0.01);
}

// A step from 1 to 1.5 in any unit.
TEST(PixelRange, RelativeDepthsDoNotDependOnTheSizeOfTheScene) {
    for (const float unit : {0.01f, 1.0f, 1000.0f}) {
        const PixelLight near{.depth = unit}, far{.depth = 1.5f * unit}, next{.depth = 1.02f * unit};
        EXPECT_LT(leak_into_dark(",depth_metric=relative,sigma_d=0.05", near, far), 1e-5) << unit;
        EXPECT_GT(leak_into_dark(",depth_metric=relative,sigma_d=0.05", near, next), 0.1) << unit;
        EXPECT_EQ(leak_into_dark("", near, far) < 1e-5, unit > 100.0f) << unit;
    }
    const PixelLight near{}, miss{.depth = std::numeric_limits<float>::infinity()};
    EXPECT_LT(leak_into_dark(",depth_metric=relative", near, miss), 1e-5);
}

// Noise of the low-variance light stays, unless all light is filtered.
TEST(PixelRange, AllLightIsFilteredWhereAsked) {
    const Inputs inputs = pixel_inputs(48, 48, [](std::uint32_t x, std::uint32_t y) {
        return PixelLight{.high = 1.0f, .variance = 1.0f, .low = 2.0f * noise(6, x, y)};
    });
    const auto deviation = [&](const std::string& options) {
        const Output out = run_filter(FilteredLight + options, inputs);
        double sum = 0.0;
        for (std::uint32_t y = 16; y < 32; ++y) {
            for (std::uint32_t x = 16; x < 32; ++x)
                sum += std::pow(double(out.picture.row(1, y)[x]) - 2.0, 2);
        }
        return std::sqrt(sum / 256.0);
    };
    EXPECT_NEAR(deviation(""), 2.0 / std::sqrt(12.0), 0.05);
    EXPECT_LT(deviation(",light=all"), 0.1);
    const Choice choice = parse_choice("pixel:light=all", catalog()).value();
    EXPECT_EQ(choice.channels(), (frame::ChannelSet{Channel::Radiance, Channel::Depth, Channel::Headlight}));
}

}  // namespace
}  // namespace tessera::filter

// What LostLight gives back, and to which pixels.
#include "master/filter/lost_light.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace tessera::filter {
namespace {

constexpr std::uint32_t LightWidth = 40, LightHeight = 24;

// U of `value(x, y)` in all components, with one variance and four samples everywhere.
template <class Value>
Inputs samples(const Value& value, float variance, std::uint32_t components = 3) {
    Inputs inputs;
    inputs.width = LightWidth;
    inputs.height = LightHeight;
    inputs.counts = Planes(LightWidth, LightHeight, 1);
    std::ranges::fill(inputs.counts.values(), 4.0f);
    inputs.means[0] = Planes(LightWidth, LightHeight, 3);
    inputs.variances[0] = Planes(LightWidth, LightHeight, 3);
    std::ranges::fill(inputs.variances[0].values(), variance);
    for (std::uint32_t c = 0; c < 3; ++c) {
        for (std::uint32_t y = 0; y < LightHeight; ++y) {
            for (std::uint32_t x = 0; x < LightWidth; ++x) inputs.means[0].row(c, y)[x] = value(x, y);
        }
    }
    if (components > 3) {
        auto& alpha = inputs.means[static_cast<std::size_t>(frame::Channel::Alpha)];
        alpha = Planes(LightWidth, LightHeight, 1);
        std::ranges::fill(alpha.values(), 1.0f);
    }
    return inputs;
}

Planes times(const Inputs& inputs, float factor) {
    Planes picture(LightWidth, LightHeight, inputs.color_components());
    for (std::uint32_t c = 0; c < picture.components(); ++c) {
        std::ranges::transform(inputs.color(c), picture.plane(c).begin(),
                               [&](float value) { return factor * value; });
    }
    return picture;
}

Planes restored(const Inputs& inputs, Planes picture, float noise = 1.0f) {
    const std::vector<float> noises(inputs.pixel_count(), noise);
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    LostLight lost_light;
    EXPECT_TRUE(lost_light.restore(inputs, frame::Channel::Radiance, noises, picture, context));
    return picture;
}

double total(std::span<const float> values) {
    double light = 0.0;
    for (const float value : values) light += double(value);
    return light;
}

float one(std::uint32_t, std::uint32_t) {
    return 1.0f;
}

TEST(LostLight, ComesBackWholeIfItIsCertain) {
    const auto ramp = [](std::uint32_t x, std::uint32_t y) { return 0.1f + float(x * y % 7); };
    const Inputs inputs = samples(ramp, 1e-9f, 4);
    for (const float factor : {0.5f, 0.9f, 0.99f, 1.01f}) {
        const Planes before = times(inputs, factor), after = restored(inputs, before);
        for (std::uint32_t c = 0; c < 3; ++c) {
            const double light = total(inputs.color(c)), lost = light - total(before.plane(c));
            EXPECT_NEAR(total(after.plane(c)), light, 0.05 * std::fabs(lost)) << factor;
        }
        for (const float alpha : after.plane(3)) EXPECT_NEAR(alpha, 1.0f, std::fabs(factor - 1.0f)) << factor;
    }
}

TEST(LostLight, IsTakenAwayWhereThereIsTooMuch) {
    const Inputs inputs = samples([](std::uint32_t x, auto) { return x < 4 ? 0.0f : 1.0f; }, 1e-9f);
    Planes before = times(inputs, 1.2f);
    const Planes after = restored(inputs, before);
    EXPECT_NEAR(total(after.plane(1)), total(inputs.color(1)),
                0.03 * total(inputs.color(1)));  // none is left where there was none
    for (const float value : after.plane(1)) EXPECT_GE(value, 0.0f);
}

// Independent noise is no loss, nor is a single firefly.
TEST(LostLight, IsNotTheNoiseOfTheSamples) {
    std::mt19937 random(7);
    std::normal_distribution<float> noise(1.0f, 0.05f);
    const Inputs inputs = samples([&](auto, auto) { return noise(random); }, 0.0025f);
    Planes flat(LightWidth, LightHeight, 3);
    std::ranges::fill(flat.values(), 1.0f);
    const Planes after = restored(inputs, flat);
    EXPECT_TRUE(std::ranges::equal(after.values(), flat.values()));

    Inputs firefly = samples([](auto x, auto y) { return x == 9 && y == 9 ? 1e6f : 1.0f; }, 1e-9f);
    for (std::uint32_t c = 0; c < 3; ++c) firefly.variances[0].row(c, 9)[9] = 1e12f;  // of one find
    const Planes removed = restored(firefly, flat);
    for (const float value : removed.values()) EXPECT_NEAR(value, 1.0f, 1e-3f);
}

TEST(LostLight, GoesWhereTheNoiseIs) {
    const Inputs inputs = samples(one, 1e-9f);
    Planes picture = times(inputs, 0.9f);
    for (std::uint32_t y = 1; y < LightHeight; y += 2)
        std::ranges::fill_n(picture.row(0, y), LightWidth, 1.06f);
    std::vector<float> noises(inputs.pixel_count(), 1.0f);
    for (std::size_t i = 0; i < noises.size(); i += 2) noises[i] = 0.25f;
    tbb::task_arena arena(2);
    RunContext context{arena, {}};
    LostLight lost_light;
    ASSERT_TRUE(lost_light.restore(inputs, frame::Channel::Radiance, noises, picture, context));
    EXPECT_NEAR((picture.row(0, 0)[1] - 0.9f) / (picture.row(0, 0)[0] - 0.9f), 4.0f, 0.01f);
    EXPECT_NEAR((picture.row(0, 1)[1] - 1.06f) / (picture.row(0, 0)[1] - 0.9f), 1.0f, 0.01f);
    EXPECT_NEAR(total(picture.plane(0)) / total(inputs.color(0)), 1.0, 1e-4);
}

TEST(LostLight, FewSamplesAndNoNoiseChangeNothing) {
    Inputs inputs = samples(one, 1e-9f);
    const Planes before = times(inputs, 0.5f);
    EXPECT_TRUE(std::ranges::equal(restored(inputs, before, 0.0f).values(), before.values()));
    for (const float count : {0.0f, 1.0f}) {
        std::ranges::fill(inputs.counts.values(), count);
        EXPECT_TRUE(std::ranges::equal(restored(inputs, before).values(), before.values())) << count;
    }
    std::ranges::fill(inputs.counts.values(), 4.0f);
    EXPECT_TRUE(std::ranges::equal(restored(inputs, times(inputs, 1.0f)).values(), inputs.means[0].values()));
}

// One pixel of 1e6 among 1e-3, numbers near the ends of the range, and weights that differ by many orders.
TEST(LostLight, IsFiniteAtExtremes) {
    for (const float scale : {1e-35f, 1e-3f, 1.0f, 1e30f}) {
        const auto firefly = [&](std::uint32_t x, std::uint32_t y) {
            return x == 5 && y == 5 ? std::min(1e9f * scale, 1e37f) : scale;
        };
        for (const float variance : {0.0f, 1e-30f, 1e30f}) {
            const Inputs inputs = samples(firefly, variance);
            for (const float noise : {1e-37f, 1e-10f, 1.0f, 1e37f}) {
                for (const float factor : {0.0f, 0.5f, 2.0f}) {
                    const Planes after = restored(inputs, times(inputs, factor), noise);
                    for (const float value : after.values()) {
                        ASSERT_TRUE(std::isfinite(value));
                        ASSERT_GE(value, 0.0f);
                    }
                }
            }
        }
    }
}

}  // namespace
}  // namespace tessera::filter

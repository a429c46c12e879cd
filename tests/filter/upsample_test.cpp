// Upsampling of pictures guided by features.
#include "master/filter/upsample.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/filter/synthetic.h"

namespace tessera::filter {
namespace {

constexpr frame::ChannelSet Features{frame::Channel::Radiance, frame::Channel::Albedo, frame::Channel::Normal,
                                     frame::Channel::Depth, frame::Channel::Alpha};

Planes colors(const Inputs& inputs, std::uint32_t components) {
    Planes planes(inputs.width, inputs.height, components);
    for (std::uint32_t c = 0; c < components; ++c)
        std::ranges::copy(inputs.color(c), planes.plane(c).begin());
    return planes;
}

Planes upsampled(const Inputs& small, const Inputs& full, std::uint32_t components = 3) {
    Planes out;
    tbb::task_arena arena(2);
    EXPECT_TRUE(upsample(colors(small, components), small, full, out, {arena, {}}));
    return out;
}

// A wall whose albedo and depth change at a third of the width; light is `light` everywhere.
Sampler two_walls(std::uint32_t width, float light) {
    return [=](std::uint32_t x, std::uint32_t, std::uint64_t) {
        SyntheticSample s;
        const bool left = x < width / 3;
        const float albedo = left ? 0.2f : 0.8f;
        s.albedo = {albedo, albedo, albedo};
        s.low = {albedo * light, albedo * light, albedo * light};
        s.depth = left ? 1.0f : 4.0f;
        s.normal = left ? std::array{1.0f, 0.0f, 0.0f} : std::array{0.0f, 0.0f, 1.0f};
        return s;
    };
}

TEST(Upsample, ConstantStaysConstant) {
    const auto flat = [](auto...) {
        SyntheticSample s;
        s.low = {0.3f, 0.6f, 1e4f};
        return s;
    };
    const Planes out =
        upsampled(synthetic_inputs(9, 7, 2, flat, Features), synthetic_inputs(33, 28, 1, flat, Features));
    for (const float value : out.plane(0)) EXPECT_NEAR(value, 0.3f, 3e-7f);
    for (const float value : out.plane(2)) EXPECT_NEAR(value, 1e4f, 1e-2f);
}

TEST(Upsample, EdgesAndTexturesComeFromTheFeatures) {
    const Inputs small = synthetic_inputs(30, 20, 2, two_walls(30, 2.0f), Features);
    const Inputs full = synthetic_inputs(60, 40, 1, two_walls(60, 2.0f), Features);
    const Planes out = upsampled(small, full);
    for (std::uint32_t x = 0; x < 60; ++x) {
        EXPECT_NEAR(out.row(0, 20)[x], x < 20 ? 0.4f : 1.6f, 0.01f) << x;
    }
}

TEST(Upsample, HolesAndBackgroundAreFinite) {
    const auto sky = [](std::uint32_t x, std::uint32_t, std::uint64_t) {
        SyntheticSample s;
        if (x % 3 != 0) return s;
        s.depth = std::numeric_limits<float>::infinity();
        s.albedo = s.normal = {0.0f, 0.0f, 0.0f};
        s.alpha = 0.0f;
        return s;
    };
    for (const std::uint64_t n : {0u, 1u}) {
        const Planes out = upsampled(synthetic_inputs(8, 8, n, sky, Features),
                                     synthetic_inputs(31, 17, 1, sky, Features), 4);
        for (const float value : out.values()) EXPECT_TRUE(std::isfinite(value));
        EXPECT_EQ(out.row(3, 0)[0], 0.0f) << "alpha is that of the full size";
        EXPECT_EQ(out.row(3, 0)[1], 1.0f);
    }
}

}  // namespace
}  // namespace tessera::filter

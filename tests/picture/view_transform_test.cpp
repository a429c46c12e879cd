// Exposure and view transforms: known inputs give known bytes, and any input is handled.
#include "mediator/picture/view_transform.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mediator/base/random.h"
#include "mediator/picture/exposure.h"
#include "mediator/picture/picture_encoder.h"

namespace tessera::picture {
namespace {

using Kind = view::ViewTransform;
using Bytes = std::vector<std::uint8_t>;

frame::Image pixels(std::initializer_list<std::array<float, 3>> colors) {
    frame::Image image(static_cast<std::uint32_t>(colors.size()), 1, 3);
    auto out = image.values.begin();
    for (const auto& color : colors) out = std::copy(color.begin(), color.end(), out);
    return image;
}

// Calculated from the specifications in double precision, apart from this code.
TEST(ViewTransform, MapsKnownValuesToKnownBytes) {
    const frame::Image light = pixels({{0.18f, 0.18f, 0.18f},
                                       {1, 1, 1},
                                       {4, 4, 4},
                                       {0.8f, 0.1f, 0.05f},
                                       {10, 0.5f, 0.02f},
                                       {0.02f, 0.03f, 0.04f},
                                       {0, 0, 0},
                                       {1000, 1000, 1000}});
    EXPECT_EQ(srgb_bytes(light, {Kind::Neutral, 0.0}),
              (Bytes{105, 105, 105, 240, 240, 240, 253, 253, 253, 227, 72,  34,
                     254, 202, 199, 8,   29,  41,  0,   0,   0,   255, 255, 255}));
    EXPECT_EQ(srgb_bytes(light, {Kind::Agx, 0.0}),
              (Bytes{128, 128, 128, 202, 202, 202, 240, 240, 240, 204, 110, 88,
                     255, 196, 166, 36,  50,  61,  0,   0,   0,   255, 255, 255}));
    EXPECT_EQ(srgb_bytes(light, {Kind::Reinhard, 0.0}),
              (Bytes{109, 109, 109, 193, 193, 193, 255, 255, 255, 211, 81,  57,
                     255, 113, 19,  38,  48,  56,  0,   0,   0,   255, 255, 255}));
    EXPECT_EQ(srgb_bytes(light, {Kind::Linear, 0.0}),
              (Bytes{118, 118, 118, 255, 255, 255, 255, 255, 255, 231, 89,  63,
                     255, 188, 39,  39,  48,  56,  0,   0,   0,   255, 255, 255}));
}

TEST(ViewTransform, AStopDoublesTheLight) {
    const frame::Image light = pixels({{0.2f, 0.3f, 0.1f}}), twice = pixels({{0.4f, 0.6f, 0.2f}});
    for (const Kind kind : {Kind::Neutral, Kind::Agx, Kind::Reinhard, Kind::Linear})
        EXPECT_EQ(srgb_bytes(light, {kind, 1.0}), srgb_bytes(twice, {kind, 0.0}));
}

TEST(ViewTransform, OfAnyValueIsFiniteAndNotNegative) {
    constexpr float Infinity = std::numeric_limits<float>::infinity();
    const float hard[] = {0.0f,  -0.0f, -1.0f, 1e-45f,    1e-38f,   1e-10f, 0.0799999f,
                          0.08f, 0.76f, 1e10f, 3.402e38f, Infinity, NAN,    -Infinity};
    for (const Kind kind : {Kind::Neutral, Kind::Agx, Kind::Reinhard, Kind::Linear}) {
        for (const double exposure : {-60.0, 0.0, 60.0}) {
            const ViewTransform transform(kind, exposure);
            for (const float r : hard) {
                for (const float g : hard) {
                    for (const float b : hard) {
                        for (const float value : transform(r, g, b)) {
                            ASSERT_TRUE(std::isfinite(value) && value >= 0.0f)
                                << enumerator_name(kind) << " of " << r << " " << g << " " << b << " at "
                                << exposure << " EV: " << value;
                        }
                    }
                }
            }
        }
    }
}

TEST(ViewTransform, GreyStaysGreyAndGetsNoDarkerWithMoreLight) {
    for (const Kind kind : {Kind::Neutral, Kind::Agx, Kind::Reinhard, Kind::Linear}) {
        const ViewTransform transform(kind, 0.0);
        float last = 0.0f;
        for (float stop = -16.0f; stop < 20.0f; stop += 0.01f) {
            const float light = std::exp2(stop);
            const auto [r, g, b] = transform(light, light, light);
            EXPECT_NEAR(r, g, 2e-6f * g + 1e-7f) << enumerator_name(kind) << " at " << light;
            EXPECT_NEAR(b, g, 2e-6f * g + 1e-7f) << enumerator_name(kind) << " at " << light;
            ASSERT_GE(g, last * (1.0f - 1e-6f)) << enumerator_name(kind) << " at " << light;
            last = g;
        }
        EXPECT_GE(last, 0.999f) << enumerator_name(kind);
    }
}

TEST(ViewTransform, NeutralKeepsTheColoursOfMaterials) {
    const ViewTransform neutral(Kind::Neutral, 0.0);
    // A base colour under white light with 4 % of reflection on top comes back as it was chosen.
    const auto [r, g, b] = neutral(0.5f + 0.04f, 0.3f + 0.04f, 0.05f + 0.04f);
    EXPECT_NEAR(r, 0.5f, 1e-6f);
    EXPECT_NEAR(g, 0.3f, 1e-6f);
    EXPECT_NEAR(b, 0.05f, 1e-6f);
}

frame::Image random_light(float scale, std::uint64_t seed = 3) {
    frame::Image image(64, 32, 3);
    CounterRandom random(seed);
    for (float& value : image.values) value = scale * std::exp2(4.0f * random.uniform() - 2.0f);
    return image;
}

TEST(Exposure, MapsTheMeanToMiddleGreyForAnyUnit) {
    frame::Image grey(4, 4, 3);
    std::fill(grey.values.begin(), grey.values.end(), 0.18f * 8.0f);
    EXPECT_NEAR(*measured_exposure(grey), -3.0, 1e-6);
    const double reference = *measured_exposure(random_light(1.0f));
    for (const int stops : {-30, -3, 1, 12, 30})
        EXPECT_NEAR(*measured_exposure(random_light(std::exp2(float(stops)))), reference - stops, 1e-5);
}

TEST(Exposure, IsRobustToLampsAndDarkCorners) {
    const double reference = *measured_exposure(random_light(1.0f));
    frame::Image with_lamp = random_light(1.0f), with_corner = with_lamp, with_holes = with_lamp;
    for (std::size_t i = 0; i < with_lamp.pixel_count() / 25; ++i) {  // 4 %
        std::fill_n(with_lamp.pixel(i).begin(), 3, 1e6f);
        std::fill_n(with_corner.pixel(i).begin(), 3, 1e-6f);
        std::fill_n(with_holes.pixel(i).begin(), 3, i % 2 == 0 ? 0.0f : NAN);
    }
    EXPECT_NEAR(*measured_exposure(with_lamp), reference, 0.1);
    EXPECT_NEAR(*measured_exposure(with_corner), reference, 0.1);
    EXPECT_NEAR(*measured_exposure(with_holes), reference, 0.1);
}

TEST(Exposure, AWhiteFloorInFrontOfADarkBackdropIsNotOverexposed) {
    frame::Image image(10, 10, 3);
    for (std::size_t i = 0; i < image.pixel_count(); ++i)
        std::fill_n(image.pixel(i).begin(), 3, i < 45 ? 0.01f : 1.0f);
    EXPECT_NEAR(*measured_exposure(image), std::log2(0.8), 1e-6);
    for (std::size_t i = 0; i < image.pixel_count(); ++i)  // a window: less than a fifth may be white
        std::fill_n(image.pixel(i).begin(), 3, i < 81 ? 0.18f : 100.0f);
    EXPECT_GT(*measured_exposure(image), -1.6);
}

TEST(Exposure, IsEmptyForTransparentOrBlackPictures) {
    EXPECT_FALSE(measured_exposure(frame::Image(8, 8, 3)));
    frame::Image hidden(2, 1, 4);
    hidden.values = {9, 9, 9, 0, 0.18f, 0.18f, 0.18f, 1};
    EXPECT_NEAR(*measured_exposure(hidden), 0.0, 1e-6);
    frame::Image one(1, 1, 3);
    one.values = {1e-45f, 1e-45f, 1e-45f};
    EXPECT_EQ(*measured_exposure(one), view::MaxExposure);
    EXPECT_EQ(*with_exposure({}, frame::Image(8, 8, 3)).exposure, 0.0);
    EXPECT_EQ(*with_exposure({Kind::Agx, 2.5}, hidden).exposure, 2.5);
}

TEST(EncodedPicture, RecordsItsExposure) {
    frame::Image image(2, 2, 3);
    std::fill(image.values.begin(), image.values.end(), 0.72f);
    for (const FileFormat format : {FileFormat::Png, FileFormat::Jpeg}) {
        const auto bytes = encode_picture(image, format, {});
        const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        EXPECT_NE(text.find("tessera.displayTransform"), std::string::npos);
        EXPECT_NE(text.find("neutral, exposure -2.00 EV"), std::string::npos);
    }
    EXPECT_EQ(encode_picture(image, FileFormat::Exr, {Kind::Agx, 9.0}),
              encode_picture(image, FileFormat::Exr, {}))
        << "linear light";
}

}  // namespace
}  // namespace tessera::picture

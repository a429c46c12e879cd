// From an eye's picture to the device: warp, blend, colour.
#include "mediator/display/output_pipeline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "mediator/base/error.h"
#include "mediator/base/random.h"
#include "mediator/display/frustum.h"
#include "tests/display/pipeline_output.h"

namespace tessera::display {
namespace {

using test::Picture;
using test::Rgb;
using test::show;

Output screen(std::uint32_t width, std::uint32_t height) {
    return {.name = "screen", .width = width, .height = height, .view_width = width, .view_height = height};
}

Picture numbered(std::uint32_t width, std::uint32_t height) {
    return {width, height, [=](std::uint32_t x, std::uint32_t y) {
                const auto number = static_cast<float>(y * width + x);
                return Rgb{number, 100 + number, 200 - number};
            }};
}

TEST(OutputPipeline, UnprocessedBytesAreCopied) {
    const scene::BlobStore none;
    OutputPipeline pipeline(screen(5, 3), none);
    const auto shown = show<std::uint8_t>(pipeline, {numbered(5, 3).bytes()});
    for (std::uint32_t i = 0; i < 15; ++i)
        EXPECT_EQ(
            shown.at(5, i % 5, i / 5),
            (std::array<std::uint8_t, 3>{static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(100 + i),
                                         static_cast<std::uint8_t>(200 - i)}));
}

// A rotated device of 3 x 2 shows a picture of 2 x 3:  0 1 / 2 3 / 4 5.
TEST(OutputPipeline, PictureIsRotatedAgainstTheDevice) {
    const scene::BlobStore none;
    const auto reds = [&](Turn turn, std::uint32_t width, std::uint32_t height) {
        Output output = screen(3, 2);
        output.turn = turn;
        OutputPipeline pipeline(output, none);
        const auto shown = show<std::uint8_t>(pipeline, {numbered(width, height).bytes()});
        std::vector<int> result;
        for (std::size_t i = 0; i < 6; ++i) result.push_back(shown.pictures[0][3 * i]);
        return result;
    };
    EXPECT_EQ(reds(Turn::Quarter, 2, 3), (std::vector{1, 3, 5, 0, 2, 4}));  // its top edge is on the right
    EXPECT_EQ(reds(Turn::ThreeQuarters, 2, 3), (std::vector{4, 2, 0, 5, 3, 1}));
    EXPECT_EQ(reds(Turn::Half, 3, 2), (std::vector{5, 4, 3, 2, 1, 0}));
}

TEST(OutputPipeline, TurnedLinearLightEqualsTurnedBytes) {
    const scene::BlobStore none;
    for (const Turn turn : {Turn::Quarter, Turn::Half, Turn::ThreeQuarters}) {
        const bool is_on_side = turn != Turn::Half;
        Output plain = screen(24, 16), exact = plain;
        plain.turn = exact.turn = turn;
        exact.color.gain = {1.0, 1.0, 1.0 - 1e-12};  // uses the general path
        OutputPipeline short_way(plain, none), long_way(exact, none);
        const Picture picture = is_on_side ? numbered(16, 24) : numbered(24, 16);
        EXPECT_EQ(show<std::uint8_t>(long_way, {picture.bytes()}).pictures,
                  show<std::uint8_t>(short_way, {picture.bytes()}).pictures);
    }
}

TEST(OutputPipeline, CoarsePicturesAreUpscaledInLinearLight) {
    const scene::BlobStore none;
    OutputPipeline pipeline(screen(16, 8), none);
    const auto flat = show<std::uint8_t>(pipeline, {Picture(2, 1, Rgb{77, 200, 3}).bytes()});
    for (std::uint32_t i = 0; i < 128; ++i)
        EXPECT_EQ(flat.at(16, i % 16, i / 16), (std::array<std::uint8_t, 3>{77, 200, 3}));
    const auto ramp = show<float>(pipeline, {Picture(2, 1, [](auto x, auto) {
                                                 return Rgb{static_cast<float>(x), 0, 0};
                                             }).half()});
    const DeviceColor srgb{Color{}};
    for (std::uint32_t x = 0; x < 16; ++x) {
        const double expected = std::clamp((x + 0.5) / 8.0 - 0.5, 0.0, 1.0);
        EXPECT_NEAR(srgb.light(ramp.at(16, x, 5)[0]), expected, 1e-6);
    }
    EXPECT_EQ(show<float>(pipeline, {Picture(1, 1, Rgb{1, 1, 1}).half()}).at(16, 15, 7), (Rgb{1, 1, 1}));
}

std::vector<Color> colors() {
    std::vector<Color> result(4);
    for (std::size_t i = 1; i < 4; ++i) result[i].gamma = std::array{0.0, 1.0, 2.2, 2.6}[i];
    return result;
}

TEST(OutputPipeline, ExactCodesAreNotDithered) {
    const scene::BlobStore none;
    for (const Color& color : colors()) {
        Output output = screen(256, 8);
        output.color = color;
        OutputPipeline pipeline(output, none);
        const DeviceColor device(color);
        const Picture picture(256, 8, [&](auto x, auto) {
            const auto light = static_cast<float>(device.light(x / 255.0));
            return Rgb{light, light, light};
        });
        const auto shown = show<std::uint8_t>(pipeline, {picture.half()});
        // For higher gammas the first codes are darker than the smallest half float.
        const std::uint32_t first = color.gamma > 2.2 ? 4 : 0;
        for (std::uint32_t y = 0; y < 8; ++y)
            for (std::uint32_t code = first; code < 256; ++code)
                ASSERT_EQ(shown.at(256, code, y)[1], code) << "gamma " << color.gamma << ", row " << y;
    }
}

TEST(OutputPipeline, DitheringPreservesMeanLight) {
    const scene::BlobStore none;
    for (const Color& color : colors()) {
        Output output = screen(8, 8);
        output.color = color;
        OutputPipeline pipeline(output, none);
        const DeviceColor device(color);
        CounterRandom random(7);
        for (int round = 0; round < 200; ++round) {
            const double asked =
                device.light(8.0 / 255.0) * std::pow(1.0 / device.light(8.0 / 255.0), random.uniform());
            const auto value = static_cast<float>(asked);
            const auto shown = show<std::uint8_t>(pipeline, {Picture(8, 8, Rgb{value, value, value}).half()});
            double mean = 0.0;
            for (std::uint32_t i = 0; i < 64; ++i)
                mean += device.light(shown.at(8, i % 8, i / 8)[2] / 255.0) / 64.0;
            // A 64th of the step between codes, two half float roundings, and the tolerance of exact codes.
            const double step = 2.7 / (255.0 * device.device_value(asked));
            ASSERT_NEAR(mean / asked, 1.0, step / 64.0 + 3.0 * 0x1p-11)
                << "gamma " << color.gamma << " " << asked;
        }
    }
}

// A node in each corner of the wall.
Output on_wall(scene::BlobStore& arrays, std::uint32_t width, std::uint32_t height, double shift = 0.0) {
    Output output = screen(width, height);
    output.plane = test::wall();
    const auto dx = static_cast<float>(shift * 2.0 / width);
    output.points = test::put(arrays, 2, 2, 3, Grid::Nodes::Edges,
                              {-1 + dx, 0.5, -2, 1 + dx, 0.5, -2, -1 + dx, -0.5, -2, 1 + dx, -0.5, -2});
    return output;
}

Picture noise(std::uint32_t width, std::uint32_t height) {
    CounterRandom random(3);
    return {width, height, [&](auto, auto) {
                return Rgb{static_cast<float>(random.uniform()), static_cast<float>(random.uniform()),
                           static_cast<float>(random.uniform())};
            }};
}

TEST(Warp, FlatWallPictureIsIndependentOfTheEye) {
    scene::BlobStore arrays;
    const Output output = on_wall(arrays, 64, 32);
    OutputPipeline warped(output, arrays), plain(screen(64, 32), arrays);
    const auto expected = show<float>(plain, {noise(64, 32).half()});
    CounterRandom random(11);
    for (int round = 0; round < 20; ++round) {
        const Head head{
            .position = {6 * random.uniform() - 3, 6 * random.uniform() - 3, 4 * random.uniform() - 1.9}};
        warped.set_frustum(view::Eye::Mono, frustum(output.plane, head, view::Eye::Mono, 0.0, 0.0));
        const auto shown = show<float>(warped, {noise(64, 32).half()});
        for (std::size_t i = 0; i < shown.pictures[0].size(); ++i)
            ASSERT_NEAR(shown.pictures[0][i], expected.pictures[0][i], 2e-4) << i;
    }
}

TEST(Warp, ShiftByOneAndAHalfPixelsInterpolatesAndIsBlackOutside) {
    scene::BlobStore arrays;
    const Output output = on_wall(arrays, 64, 32, 1.5);
    OutputPipeline pipeline(output, arrays);
    pipeline.set_frustum(view::Eye::Mono, frustum(output.plane, {}, view::Eye::Mono, 0.0, 0.0));
    const Picture stripes(64, 32, [](auto x, auto) { return Rgb{static_cast<float>(x) / 128.0f, 1, 0}; });
    const auto shown = show<float>(pipeline, {stripes.half()});
    const DeviceColor srgb{Color{}};
    for (std::uint32_t x = 0; x < 62; ++x)
        EXPECT_NEAR(srgb.light(shown.at(64, x, 9)[0]), (x + 1.5) / 128.0, 1e-5) << x;
    EXPECT_EQ(shown.at(64, 63, 9), (Rgb{0, 0, 0}));
}

TEST(Warp, InvisiblePointsAreBlack) {
    scene::BlobStore arrays;
    Output output = on_wall(arrays, 4, 4);
    std::vector<float> points;
    for (int i = 0; i < 16; ++i) points.insert(points.end(), {0.0f, 0.0f, i < 8 ? -2.0f : 1.0f});
    points[0] = std::numeric_limits<float>::quiet_NaN();
    output.points = test::put(arrays, 4, 4, 3, Grid::Nodes::Centres, points);
    OutputPipeline pipeline(output, arrays);
    pipeline.set_frustum(view::Eye::Mono, frustum(output.plane, {}, view::Eye::Mono, 0.0, 0.0));
    const auto shown = show<std::uint8_t>(pipeline, {Picture(4, 4, Rgb{1, 1, 1}).half()});
    EXPECT_EQ(shown.at(4, 0, 0)[0], 0) << "not a number";
    EXPECT_EQ(shown.at(4, 1, 0)[0], 255);
    EXPECT_EQ(shown.at(4, 1, 3)[0], 0) << "behind the eye";
    EXPECT_EQ(shown.report.not_finite, 0u) << "of pictures";
}

TEST(Warp, NonFinitePixelsAreBlackAndCounted) {
    const scene::BlobStore none;
    OutputPipeline pipeline(screen(13, 2), none);
    const Picture picture(13, 2, [](auto x, auto y) {
        if (x == 3 && y == 0) return Rgb{0, std::numeric_limits<float>::quiet_NaN(), 0};
        if (x == 12 && y == 1) return Rgb{1, 1, -std::numeric_limits<float>::infinity()};
        return Rgb{-3, 60000, 1};
    });
    const auto shown = show<std::uint8_t>(pipeline, {picture.half()});
    EXPECT_EQ(shown.report.not_finite, 2u);
    EXPECT_EQ(shown.at(13, 3, 0), (std::array<std::uint8_t, 3>{0, 0, 0}));
    EXPECT_EQ(shown.at(13, 12, 1), (std::array<std::uint8_t, 3>{0, 0, 0}));
    EXPECT_EQ(shown.at(13, 4, 0), (std::array<std::uint8_t, 3>{0, 255, 255}));
}

// Points at distance d from the head have no parallax: a virtual screen is assumed there. The real screen looks the same
// from eyes whose separation is scaled by D / d.
TEST(Warp, ZeroParallaxEqualsScaledEyeSeparation) {
    const ProjectionPlane plane = test::wall();
    const Head head{.position = {0.3, -0.2, 0.5}};
    const double far = 2.5, near = 1.7, separation = 0.064;
    const view::CameraPose picture = frustum(plane, head, view::Eye::Right, separation, near);
    const view::CameraPose screen_itself =
        frustum(plane, head, view::Eye::Right, separation * far / near, 0.0);
    EXPECT_NEAR(picture.left, screen_itself.left, 1e-12);
    EXPECT_NEAR(picture.right, screen_itself.right, 1e-12);
    EXPECT_NEAR(picture.bottom, screen_itself.bottom, 1e-12);
    EXPECT_NEAR(picture.top, screen_itself.top, 1e-12);
    const auto seen = [](const view::CameraPose& camera, const glm::dvec3& point) {
        const glm::dvec4 local = glm::inverse(camera.world_from_camera) * glm::dvec4(point, 1.0);
        return glm::dvec2(local.x, local.y) / -local.z;
    };
    for (const glm::dvec3 point :
         {glm::dvec3{0.7, 0.1, -2.0}, {-0.4, 0.3, -2.6}}) {  // one is on a curved part
        const glm::dvec3 virtual_point = head.position + near / far * (point - head.position);
        EXPECT_NEAR(glm::length(seen(picture, virtual_point) - seen(screen_itself, point)), 0.0, 1e-12);
    }
}

TEST(Blend, OverlappingRampsSumToOne) {
    const scene::BlobStore none;
    Output left = screen(40, 4), right = screen(40, 4);
    left.blend = {.right = 12, .shape = 2.0};
    right.blend = {.left = 12, .shape = 2.0};
    OutputPipeline first(left, none), second(right, none);
    const Picture grey(40, 4, Rgb{0.25f, 0.5f, 1.0f});
    const auto a = show<float>(first, {grey.half()}), b = show<float>(second, {grey.half()});
    const DeviceColor srgb{Color{}};
    for (std::uint32_t x = 0; x < 12; ++x)
        EXPECT_NEAR(srgb.light(a.at(40, 28 + x, 1)[1]) + srgb.light(b.at(40, x, 1)[1]), 0.5, 1e-6) << x;
    EXPECT_LT(a.at(40, 39, 1)[1], 0.05f);
    EXPECT_NEAR(srgb.light(a.at(40, 27, 1)[2]), 1.0, 1e-6);
}

TEST(Blend, RampsOfTurnedDevicesMatchTheUprightPicture) {
    const scene::BlobStore none;
    for (const Turn turn : {Turn::None, Turn::Quarter, Turn::Half, Turn::ThreeQuarters}) {
        Output output = screen(8, 8);
        output.turn = turn;
        output.blend = {.left = 4};
        OutputPipeline pipeline(output, none);
        Output upright = output;
        upright.turn = Turn::None;
        OutputPipeline straight(upright, none);
        const Picture white(8, 8, Rgb{1, 1, 1});
        const auto turned = show<std::uint8_t>(pipeline, {white.half()});
        const auto expected = show<float>(straight, {white.half()});
        for (std::uint32_t y = 0; y < 8; ++y)
            for (std::uint32_t x = 0; x < 8; ++x) {
                const std::array<std::array<std::uint32_t, 2>, 4> from{
                    {{x, y}, {7 - y, x}, {7 - x, 7 - y}, {y, 7 - x}}};
                const auto [ux, uy] = from[static_cast<std::size_t>(turn)];
                EXPECT_NEAR(turned.at(8, x, y)[0], 255.0 * expected.at(8, ux, uy)[0], 1.0);
            }
    }
}

TEST(Blend, LightIsClampedBeforeBlending) {
    scene::BlobStore arrays;
    Output output = screen(8, 8);
    output.blend.weights = test::put(arrays, 1, 1, 1, Grid::Nodes::Edges, {0.25f});
    output.blend.lift = test::put(arrays, 2, 1, 1, Grid::Nodes::Centres, {0.5f, 0.0f});
    output.color.gamma = 1.0;
    OutputPipeline pipeline(output, arrays);
    const auto shown = show<float>(pipeline, {Picture(8, 8, Rgb{1000, 0.5f, 0}).half()});
    EXPECT_NEAR(shown.at(8, 7, 0)[0], 0.25, 0.01);
    EXPECT_NEAR(shown.at(8, 2, 0)[0], 0.4375 + 0.5625 * 0.25, 1e-6);  // lift + (1 - lift) x weight x value
    EXPECT_NEAR(shown.at(8, 2, 0)[1], 0.4375 + 0.5625 * 0.125, 1e-6);
    EXPECT_NEAR(shown.at(8, 2, 0)[2], 0.4375, 1e-6);
}

TEST(Color, MatrixThenGainThenCurve) {
    const scene::BlobStore none;
    Output output = screen(8, 1);
    output.color.matrix[0] = {0.5, 0.25, 0.0};  // of red
    output.color.gain = {1.0, 0.5, 1.0};
    output.color.curve = {0.0f, 0.75f, 1.0f};
    OutputPipeline pipeline(output, none);
    const auto shown = show<float>(pipeline, {Picture(8, 1, Rgb{0.5f, 0.25f, 1.0f}).half()});
    EXPECT_NEAR(shown.at(8, 3, 0)[0], 0.375, 1e-6);  // 0.25
    EXPECT_NEAR(shown.at(8, 3, 0)[1], 1.5 * 0.5 * (0.125 + 0.25), 1e-6);
    EXPECT_NEAR(shown.at(8, 3, 0)[2], 1.0, 1e-6);
    const auto bytes = show<std::uint8_t>(pipeline, {Picture(8, 1, Rgb{0.5f, 0.25f, 1.0f}).half()});
    EXPECT_NEAR(bytes.at(8, 3, 0)[0], 0.375 * 255.0, 1.0);
    EXPECT_EQ(bytes.at(8, 3, 0)[2], 255);
}

TEST(OutputPipeline, ResultIsIndependentOfThreads) {
    scene::BlobStore arrays;
    Output output = on_wall(arrays, 101, 67, 0.3);
    output.blend = {.left = 20, .top = 9};
    const auto shown = [&](int threads) {
        OutputPipeline pipeline(output, arrays);
        pipeline.set_frustum(view::Eye::Mono, frustum(output.plane, {}, view::Eye::Mono, 0.0, 0.0));
        return show<std::uint8_t>(pipeline, {noise(51, 34).half()}, threads).pictures;
    };
    EXPECT_EQ(shown(1), shown(4));
}

TEST(OutputPipeline, RejectsMismatchedSizes) {
    scene::BlobStore arrays;
    Output odd = screen(5, 5);
    odd.stereo = Stereo::SideBySide;
    EXPECT_THROW(OutputPipeline(odd, arrays), Error);
    odd.stereo = Stereo::TopBottom;
    EXPECT_THROW(OutputPipeline(odd, arrays), Error);
    Output output = on_wall(arrays, 8, 8);
    EXPECT_THROW(OutputPipeline(output, scene::BlobStore()), Error);  // its points are not in the store
    output.points.rows = 3;
    EXPECT_THROW(OutputPipeline(output, arrays), Error);
    OutputPipeline pipeline(screen(8, 8), arrays);
    EyePicture short_of_bytes = Picture(8, 8, Rgb{1, 1, 1}).half();
    short_of_bytes.height = 9;
    EXPECT_THROW(show<std::uint8_t>(pipeline, {short_of_bytes}), Error);
    EXPECT_THROW(show<std::uint8_t>(pipeline, {}), Error);
}

}  // namespace
}  // namespace tessera::display

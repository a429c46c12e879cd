// Packing both eyes into one picture, without crosstalk.
#include <gtest/gtest.h>

#include <cmath>

#include "mediator/display/frustum.h"
#include "tests/display/pipeline_output.h"

namespace tessera::display {
namespace {

using test::Picture;
using test::Rgb;
using test::show;

Output screen(Stereo stereo, std::uint32_t width = 8, std::uint32_t height = 8) {
    return {.name = "screen",
            .width = width,
            .height = height,
            .stereo = stereo,
            .view_width = width,
            .view_height = height};
}

// Left: light grows with the column in red and with the row in green; right: the same in blue from above.
Rgb left_color(std::uint32_t x, std::uint32_t y) {
    return {static_cast<float>(x) / 16, static_cast<float>(y) / 16, 0.0f};
}
Rgb right_color(std::uint32_t x, std::uint32_t y) {
    return {0.0f, static_cast<float>(x) / 32, static_cast<float>(y) / 32};
}

test::PipelineOutput<float> shown(Output output) {
    output.color.gamma = 1.0;  // light itself
    const scene::BlobStore none;
    OutputPipeline pipeline(output, none);
    return show<float>(pipeline, {Picture(8, 8, left_color).half(), Picture(8, 8, right_color).half()});
}

void expect_near(const Rgb& value, const Rgb& expected) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(value[c], expected[c], 1e-6) << "component " << c;
}

Rgb mean(const Rgb& a, const Rgb& b) {
    return {0.5f * (a[0] + b[0]), 0.5f * (a[1] + b[1]), 0.5f * (a[2] + b[2])};
}

TEST(StereoPacking, SideBySideAveragesPairsOfColumns) {
    const auto picture = shown(screen(Stereo::SideBySide));
    for (std::uint32_t y = 0; y < 8; ++y)
        for (std::uint32_t x = 0; x < 4; ++x) {
            expect_near(picture.at(8, x, y), mean(left_color(2 * x, y), left_color(2 * x + 1, y)));
            expect_near(picture.at(8, 4 + x, y), mean(right_color(2 * x, y), right_color(2 * x + 1, y)));
        }
}

TEST(StereoPacking, TopBottomAveragesPairsOfRows) {
    const auto picture = shown(screen(Stereo::TopBottom));
    for (std::uint32_t y = 0; y < 4; ++y)
        for (std::uint32_t x = 0; x < 8; ++x) {
            expect_near(picture.at(8, x, y), mean(left_color(x, 2 * y), left_color(x, 2 * y + 1)));
            expect_near(picture.at(8, x, 4 + y), mean(right_color(x, 2 * y), right_color(x, 2 * y + 1)));
        }
}

TEST(StereoPacking, RowsAreInterlacedByTheRowOfTheDesktop) {
    for (const int above : {0, 1, -3, 1080}) {
        Output output = screen(Stereo::InterlacedRows);
        output.y = above;
        const auto picture = shown(output);
        for (std::uint32_t y = 0; y < 8; ++y) {
            const bool is_even = (above + static_cast<int>(y)) % 2 == 0;
            expect_near(picture.at(8, 5, y), is_even ? left_color(5, y) : right_color(5, y));
        }
        // The same in bytes that pass.
        const scene::BlobStore none;
        OutputPipeline pipeline(output, none);
        const auto bytes = show<std::uint8_t>(
            pipeline, {Picture(8, 8, Rgb{1, 1, 1}).bytes(), Picture(8, 8, Rgb{2, 2, 2}).bytes()});
        for (std::uint32_t y = 0; y < 8; ++y)
            EXPECT_EQ(bytes.at(8, 2, y)[0], (above + static_cast<int>(y)) % 2 == 0 ? 1 : 2);
    }
}

TEST(StereoPacking, SeparateEyesAreTwoPictures) {
    const auto pictures = shown(screen(Stereo::Separate));
    ASSERT_EQ(pictures.pictures.size(), 2u);
    expect_near(pictures.at(8, 3, 6, 0), left_color(3, 6));
    expect_near(pictures.at(8, 3, 6, 1), right_color(3, 6));
}

TEST(StereoPacking, PlainAnaglyphIsRedOfTheLeftEye) {
    const auto picture = shown(screen(Stereo::AnaglyphPlain));
    const Rgb left = left_color(6, 5), right = right_color(6, 5);
    expect_near(picture.at(8, 6, 5), {left[0], right[1], right[2]});
}

TEST(StereoPacking, DuboisAnaglyphKeepsWhiteAndKeepsEyesApart) {
    const scene::BlobStore none;
    Output output = screen(Stereo::AnaglyphDubois);
    output.color.gamma = 1.0;
    OutputPipeline pipeline(output, none);
    const Picture white(8, 8, Rgb{1, 1, 1}), black(8, 8, Rgb{0, 0, 0}), grey(8, 8, Rgb{0.5f, 0.5f, 0.5f});
    const auto both = show<float>(pipeline, {grey.half(), grey.half()});
    for (const float value : both.at(8, 1, 1)) EXPECT_NEAR(value, 0.5f, 1e-5f);
    const auto left = show<float>(pipeline, {white.half(), black.half()}).at(8, 1, 1);
    EXPECT_NEAR(left[0], 1.0f, 1e-6f);  // 1.133 before it is cut off
    EXPECT_EQ(left[1], 0.0f);
    EXPECT_EQ(left[2], 0.0f);
    const auto right = show<float>(pipeline, {black.half(), grey.half()}).at(8, 1, 1);
    EXPECT_EQ(right[0], 0.0f);
    EXPECT_NEAR(right[1], 0.5 * 1.0936657, 1e-6);
    EXPECT_NEAR(right[2], 0.5 * 1.0412863, 1e-6);
}

// Each eye's part of the device has exactly its own white or black: with pictures of any size, and warped.
TEST(StereoPacking, EyesDoNotMixAtTheBorder) {
    scene::BlobStore arrays;
    for (const Stereo stereo : {Stereo::SideBySide, Stereo::TopBottom, Stereo::InterlacedRows,
                                Stereo::Separate, Stereo::AnaglyphPlain})
        for (const bool is_warped : {false, true})
            for (const std::uint32_t part : {1u, 2u, 8u}) {
                Output output = screen(stereo, 64, 32);
                output.plane = test::wall();
                if (is_warped)
                    output.points = test::put(arrays, 2, 2, 3, Grid::Nodes::Edges,
                                              {-1, 0.5, -2, 1, 0.4f, -2, -0.9f, -0.5, -2, 1, -0.5, -2});
                OutputPipeline pipeline(output, arrays);
                for (const view::Eye eye : {view::Eye::Left, view::Eye::Right})
                    pipeline.set_frustum(eye, frustum(output.plane, {}, eye, 0.06, 0.0));
                const Picture white(64 / part, 32 / part, Rgb{1, 1, 1}),
                    black(64 / part, 32 / part, Rgb{0, 0, 0});
                const auto shown = show<std::uint8_t>(pipeline, {white.half(), black.half()});
                for (std::uint32_t y = 0; y < 32; ++y)
                    for (std::uint32_t x = 0; x < 64; ++x)
                        for (std::size_t p = 0; p < shown.pictures.size(); ++p)
                            for (std::size_t c = 0; c < 3; ++c) {
                                const bool is_left = stereo == Stereo::SideBySide       ? x < 32
                                                     : stereo == Stereo::TopBottom      ? y < 16
                                                     : stereo == Stereo::InterlacedRows ? y % 2 == 0
                                                     : stereo == Stereo::Separate       ? p == 0
                                                                                        : c == 0;
                                ASSERT_EQ(shown.at(64, x, y, p)[c], is_left ? 255 : 0)
                                    << "mode " << static_cast<int>(stereo) << " at " << x << ", " << y;
                            }
            }
}

}  // namespace
}  // namespace tessera::display

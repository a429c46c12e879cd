#include "mediator/display/pattern.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "mediator/display/pixel_font.h"
#include "mediator/display/wall_grid.h"

namespace tessera::display {

namespace {

Output flat(std::uint32_t width, std::uint32_t height,
            const ProjectionPlane& plane = projection_plane(Wall{})) {
    return {.name = "Wall-1",
            .width = width,
            .height = height,
            .plane = plane,
            .view_width = width,
            .view_height = height};
}

float grey(const frame::Image& image, std::uint32_t x, std::uint32_t y) {
    return image.pixel(std::size_t{y} * image.width + x)[1];
}

TEST(Pattern, TheBorderIsWhiteOnAllFourSides) {
    for (const auto& [width, height] : {std::pair{640u, 400u}, {33u, 20u}, {1u, 1u}, {3u, 500u}}) {
        const frame::Image image = pattern(flat(width, height), view::Eye::Mono);
        ASSERT_EQ(image.width, width);
        for (std::uint32_t x = 0; x < width; ++x) {
            EXPECT_EQ(grey(image, x, 0), 1.0f);
            EXPECT_EQ(grey(image, x, height - 1), 1.0f);
        }
        for (std::uint32_t y = 0; y < height; ++y) {
            EXPECT_EQ(grey(image, 0, y), 1.0f);
            EXPECT_EQ(grey(image, width - 1, y), 1.0f);
        }
        for (const float value : image.values) EXPECT_TRUE(value >= 0.0f && value <= 1.0f);
    }
}

TEST(Pattern, RampsHaveEveryStepOfEightBits) {
    const frame::Image image = pattern(flat(1920, 1080), view::Eye::Mono);
    const auto steps = [&](double v, int component) {
        std::set<long> found;
        const auto y = std::uint32_t(v * 1080);
        for (std::uint32_t x = std::uint32_t(0.155 * 1920); x < std::uint32_t(0.845 * 1920); ++x) {
            const float light = image.pixel(std::size_t{y} * 1920 + x)[std::size_t(component)];
            const double value =
                light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
            EXPECT_NEAR(255.0 * value, std::round(255.0 * value), 1e-3);
            found.insert(std::lround(255.0 * value));
        }
        return found.size();
    };
    EXPECT_GE(steps(0.616, 1), 31u);
    for (int component = 0; component < 3; ++component) EXPECT_GE(steps(0.648, component), 252u);
    EXPECT_GE(steps(0.680, 0), 252u);
    EXPECT_EQ(steps(0.680, 1), 1u);
    EXPECT_GE(steps(0.712, 1), 252u);
    EXPECT_GE(steps(0.744, 2), 252u);
}

TEST(Pattern, EyesAreDistinguishable) {
    const Output output = flat(640, 400);
    const frame::Image mono = pattern(output, view::Eye::Mono), left = pattern(output, view::Eye::Left),
                       right = pattern(output, view::Eye::Right);
    const auto whiter = [&](const frame::Image& image, std::uint32_t from, std::uint32_t to) {
        int count = 0;
        for (std::uint32_t y = 130; y < 270; ++y) {
            for (std::uint32_t x = from; x < to; ++x) count += grey(image, x, y) > grey(mono, x, y) + 0.5f;
        }
        return count;
    };
    EXPECT_GT(whiter(left, 10, 320), 500);
    EXPECT_EQ(whiter(left, 320, 630), 0);
    EXPECT_GT(whiter(right, 320, 630), 500);
    EXPECT_EQ(whiter(right, 10, 320), 0);
}

TEST(Pattern, GridLinesOfNeighboursCoincide) {
    const Wall screen{.corner = {-1.83, -1, -2}, .across = {3.6, 0, 0}, .upward = {0, 1.0, 0}};
    const std::vector<Part> all =
        parts(screen, {.columns = 2, .width = 2000, .height = 1000, .overlap_across = 400});
    const frame::Image left = pattern(flat(2000, 1000, projection_plane(screen, all[0])), view::Eye::Mono);
    const frame::Image right = pattern(flat(2000, 1000, projection_plane(screen, all[1])), view::Eye::Mono);
    int lines = 0;
    for (std::uint32_t x = 10; x < 390; ++x) {  // row 20: neither text nor circle there
        EXPECT_NEAR(grey(left, 1600 + x, 20), grey(right, x, 20), 1e-4f) << x;
        lines += grey(right, x, 20) > 0.2f;
    }
    EXPECT_GT(lines, 2);
}

TEST(Pattern, RawPatternIsPixelExact) {
    Output output = flat(300, 200);
    output.turn = Turn::Quarter;
    output.blend.left = 20;
    output.color.gamma = 2.0;
    output.view_width = 77;
    const Output plain = raw(output);
    EXPECT_EQ(plain.view_width, 200u);
    EXPECT_EQ(plain.view_height, 300u);
    EXPECT_FALSE(takes_linear_light(plain));
    EXPECT_EQ(plain.turn, Turn::Quarter);
}

TEST(PixelFont, HasGlyphsForAllNames) {
    std::set<std::uint64_t> faces;
    const std::string_view letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
    for (std::size_t i = 0; i < letters.size(); ++i) {
        std::uint64_t face = 0;
        for (std::uint32_t y = 0; y < GlyphHeight; ++y) {
            for (std::uint32_t x = 0; x < GlyphWidth; ++x)
                face = face << 1 | std::uint64_t(is_in_text(letters.substr(i, 1), x, y));
        }
        EXPECT_NE(face, 0u) << letters[i];
        EXPECT_TRUE(faces.insert(face).second) << letters[i];
    }
    EXPECT_FALSE(is_in_text("M", GlyphAdvance, 0));
    EXPECT_TRUE(is_in_text(" M", GlyphAdvance, 0));
}

}  // namespace

}  // namespace tessera::display

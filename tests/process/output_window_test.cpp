// Outputs in windows: the screen contents match the output's picture.
#include <gtest/gtest.h>
#include <signal.h>

#include <set>

#include "tests/process/display_cluster.h"
#include "tests/process/screen.h"

namespace tessera::test {
namespace {

using namespace std::chrono_literals;

display::Output window(const std::string& name, int x, int y, std::uint32_t width, std::uint32_t height) {
    display::Output output = part_of_wall(name, -1, 1);
    output.width = output.view_width = width;
    output.height = output.view_height = height;
    output.x = x;
    output.y = y;
    return output;
}

struct OutputWindows : testing::Test {
    DisplayCluster wall{1};
    Screen screen{wall.folder()};
    display::Display display{.name = "desk", .spp = 4};

    ChildProcess open_window(const display::Output& output, std::vector<std::string> more) {
        more.insert(more.end(), {"--log", wall.folder() / (output.name + ".window")});
        return start_with({screen.variable()}, wall.folder(), output.name, "tessera-display",
                          wall.arguments(output.name, std::move(more)));
    }
    // The output's picture with all samples.
    std::vector<std::uint8_t> picture(const display::Output& output) {
        const std::vector<std::uint8_t> rgb = wall.finished_png(output, display.spp);
        EXPECT_GT(std::set<std::uint8_t>(rgb.begin(), rgb.end()).size(), 16u) << "a picture of nothing";
        return rgb;
    }
    bool shows(const display::Output& output, const std::vector<std::uint8_t>& rgb) const {
        return screen.pixels(output.x, output.y, int(output.width), int(output.height)) == rgb;
    }
};

TEST_F(OutputWindows, ShowTheirPicturesAtTheirPositions) {
    const display::Output left = window("left", 40, 60, 200, 150), right = window("right", 300, 210, 121, 91);
    display.outputs = {left, right};
    wall.editor().open_display(display);
    const auto in_left = picture(left), in_right = picture(right);
    ChildProcess left_process = open_window(left, {"--window"});
    ChildProcess right_process = open_window(right, {"--window"});
    EXPECT_TRUE(happens([&] { return shows(left, in_left); })) << left_process.err();
    EXPECT_TRUE(happens([&] { return shows(right, in_right); })) << right_process.err();
    EXPECT_EQ(screen.pixels(40, 59, 200, 1), std::vector<std::uint8_t>(600, 0)) << "nothing next to it";
    left_process.signal(SIGTERM);
    EXPECT_EQ(left_process.wait(30s).value_or(-1), 0);
}

TEST_F(OutputWindows, FillTheScreenWithoutOptions) {
    const display::Output output = window("whole", 0, 0, Screen::Width, Screen::Height);
    display.outputs = {output};
    wall.editor().open_display(display);
    const auto expected = picture(output);
    ChildProcess process = open_window(output, {});
    EXPECT_TRUE(happens([&] { return shows(output, expected); })) << process.err();
}

TEST_F(OutputWindows, AreRedrawnAfterBeingCovered) {
    const display::Output under = window("under", 40, 60, 200, 150),
                          over = window("over", 100, 100, 300, 300);
    display.outputs = {under, over};
    wall.editor().open_display(display);
    const auto expected = picture(under), covering = picture(over);
    ChildProcess under_process = open_window(under, {"--window"});
    ASSERT_TRUE(happens([&] { return shows(under, expected); })) << under_process.err();
    {
        const ChildProcess over_process = open_window(over, {"--window"});
        ASSERT_TRUE(happens([&] { return shows(over, covering); })) << over_process.err();
        EXPECT_FALSE(shows(under, expected));
    }
    EXPECT_TRUE(happens([&] { return shows(under, expected); })) << "no new frame was due";
}

}  // namespace
}  // namespace tessera::test

#include "client/display_file/display_file.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mediator/display/frustum.h"
#include "tests/display/camera_math.h"

namespace tessera::display_file {

namespace {

DisplayFile parsed(std::string_view text) {
    scene::BlobStore blobs;
    return parse_display(text, "wall.toml", blobs);
}

TEST(DisplayFile, SingleMonitorNeedsThreeLines) {
    const DisplayFile file = parsed("[[output]]\nname = 'desk'\nsize = [2560, 1440]\n");
    ASSERT_EQ(file.display.outputs.size(), 1u);
    const display::Output& output = file.display.outputs[0];
    EXPECT_EQ(file.display.name, "wall");
    EXPECT_EQ(output.name, "desk");
    EXPECT_EQ(output.view_width, 2560u);
    EXPECT_FALSE(display::takes_linear_light(output));
    const view::CameraPose camera = display::frustum(output.plane, {}, view::Eye::Mono, 0.064, 0.0);
    const double top = std::tan(25.0 * 3.14159265358979323846 / 180.0);
    EXPECT_NEAR(camera.top, top, 1e-12);
    EXPECT_NEAR(camera.right, top * 2560 / 1440, 1e-12);
}

// Every key that a file may have.
constexpr std::string_view AllKeys = R"(
[display]
name = "show"
camera = "main"
units_per_metre = 100
rate = 24.5
spp = 64
filter = "nlm"
coarsest = 4
max_bounces = 3
exposure = -1.5
white = 4.0
stereo_difference = true
[head]
position = [0.1, 0.2, 0.3]
look = [1, 0, 0]
eye_separation = 0.06
zero_parallax = 2.5
[[layer]]
name = "solid"
renderer = "path"
layers = [0, 2]
[[layer]]
name = "menu"
renderer = "raster"
layers = [1]
shown = false
[[output]]
name = "a"
size = [800, 600]
x = -5
y = 7
stereo = "rows"
priority = 4
turn = 90
screen = { lower_left = [2, -1, 1], lower_right = [2, -1, 4], upper_left = [2, 1, 1] }
view = [300, 400]
blend = { left = 10, top = 20, shape = 2.0 }
color = { gain = [0.9, 1.0, 1.1], gamma = 2.2, matrix = [1, 0.1, 0, 0, 1, 0, 0, 0.2, 1] }
)";

TEST(DisplayFile, ReadsEveryKey) {
    const DisplayFile file = parsed(AllKeys);
    const display::Display& d = file.display;
    EXPECT_EQ(d.name, "show");
    EXPECT_EQ(d.camera, "main");
    EXPECT_EQ(d.units_per_metre, 100.0);
    EXPECT_EQ(d.rate, 24.5);
    EXPECT_EQ(d.spp, 64u);
    EXPECT_EQ(d.filter, "nlm");
    EXPECT_EQ(d.coarsest, 4u);
    EXPECT_EQ(d.max_bounces, 3u);
    EXPECT_EQ(d.exposure, -1.5);
    EXPECT_EQ(d.white, 4.0);
    EXPECT_EQ(d.view_transform, view::ViewTransform::Reinhard) << "the white luminance belongs to that curve";
    EXPECT_TRUE(d.stereo_difference);
    EXPECT_EQ(d.eye_separation, 0.06);
    EXPECT_EQ(d.zero_parallax, 2.5);
    const glm::dvec3 look = d.head.orientation * glm::dvec3(0, 0, -1);
    EXPECT_NEAR(glm::distance(look, glm::dvec3(1, 0, 0)), 0.0, 1e-12);
    EXPECT_NEAR((d.head.orientation * glm::dvec3(0, 1, 0)).y, 1.0, 1e-12);
    ASSERT_EQ(d.layers.size(), 2u);
    EXPECT_EQ(d.layers[0].layers, 5u);
    EXPECT_EQ(d.layers[1].renderer, view::Renderer::Raster);
    EXPECT_FALSE(d.layers[1].shown);
    const display::Output& o = d.outputs.at(0);
    EXPECT_EQ(o.x, -5);
    EXPECT_EQ(o.y, 7);
    EXPECT_EQ(o.stereo, display::Stereo::InterlacedRows);
    EXPECT_EQ(o.priority, 4u);
    EXPECT_EQ(o.turn, display::Turn::Quarter);
    EXPECT_EQ(o.view_width, 300u);
    EXPECT_EQ(o.view_height, 400u);
    EXPECT_EQ(o.blend.left, 10.0);
    EXPECT_EQ(o.blend.top, 20.0);
    EXPECT_EQ(o.blend.shape, 2.0);
    EXPECT_EQ(o.color.gain.z, 1.1);
    EXPECT_EQ(o.color.gamma, 2.2);
    EXPECT_EQ((o.color.matrix * glm::dvec3(0, 1, 0)).r, 0.1);
    EXPECT_EQ((o.color.matrix * glm::dvec3(0, 1, 0)).b, 0.2);
}

TEST(DisplayFile, AWallIsAGridOfNamedOutputs) {
    const DisplayFile file = parsed(R"(
[[wall]]
name = "w"
lower_left = [-3, -1, -2]
lower_right = [3, -1, -2]
upper_left = [-3, 1, -2]
columns = 3
rows = 2
size = [400, 300]
overlap = [40, 20]
desktop = [3, 1]
stereo = "separate"
[[adjust]]
output = "w-2-1"
priority = 8
color = { gain = 0.5 }
)");
    ASSERT_EQ(file.display.outputs.size(), 6u);
    EXPECT_EQ(file.display.outputs[0].name, "w-1-1");
    EXPECT_EQ(file.display.outputs[5].name, "w-3-2");
    const display::Output& middle = file.display.outputs[1];
    EXPECT_EQ(middle.priority, 8u);
    EXPECT_EQ(middle.color.gain, glm::dvec3(0.5));
    EXPECT_EQ(file.display.outputs[0].priority, 1u);
    EXPECT_EQ(middle.blend.left, 40.0);
    EXPECT_EQ(middle.blend.right, 40.0);
    EXPECT_EQ(middle.blend.top, 0.0);
    EXPECT_EQ(middle.blend.bottom, 20.0);
    EXPECT_EQ(file.display.outputs[0].blend.left, 0.0);
    EXPECT_EQ(middle.x, 400);
    EXPECT_EQ(file.display.outputs[4].y, 0);
    // 3 x 400 - 2 x 40 = 1120 pixels on 6 m.
    EXPECT_NEAR(middle.plane.hull[0].x, -3.0 + 6.0 * 360 / 1120, 1e-12);
    EXPECT_EQ(file.geometry[1].screen, "w");
}

TEST(DisplayFile, SoftEdgesFollowTurnedDevices) {
    const auto blend_of = [](int turn) {
        return parsed(
                   "[[wall]]\nname='w'\nlower_left=[-3,-1,-2]\nlower_right=[3,-1,-2]\nupper_left=[-3,1,-2]\n"
                   "columns=2\nsize=[400,300]\noverlap=[40,0]\nturn=" +
                   std::to_string(turn) + "\n")
            .display.outputs[0]
            .blend;  // of the left one: its right edge as seen by viewers
    };
    EXPECT_EQ(blend_of(0).right, 40.0);
    EXPECT_EQ(blend_of(90).top, 40.0);  // turned clockwise its top edge is on the right
    EXPECT_EQ(blend_of(180).left, 40.0);
    EXPECT_EQ(blend_of(270).bottom, 40.0);
    EXPECT_EQ(blend_of(90).right, 0.0);
}

TEST(DisplayFile, ProjectorPointsAreStoredAsBlobs) {
    scene::BlobStore blobs;
    const DisplayFile file = parse_display(R"(
[[screen]]
name = "w"
lower_left = [-2, -1, -3]
lower_right = [2, -1, -3]
upper_left = [-2, 1, -3]
[[output]]
name = "p"
size = [640, 400]
screen = "w"
projector = { position = [-1, 1.5, 0.5], look_at = [-0.9, 0, -3], throw = 1.5 }
)",
                                           "wall.toml", blobs);
    const display::Output& output = file.display.outputs.at(0);
    ASSERT_FALSE(output.points.empty());
    const auto blob = blobs.find(output.points.values.hash);
    ASSERT_TRUE(blob);
    const auto values = blob->as<float>();
    ASSERT_EQ(values.size(), std::size_t{3} * output.points.columns * output.points.rows);
    for (std::size_t i = 2; i < values.size(); i += 3) EXPECT_NEAR(values[i], -3.0f, 1e-6f);
    EXPECT_TRUE(file.geometry[0].projector);
    EXPECT_NEAR(glm::cross(output.plane.right, output.plane.up).z, 1.0, 1e-12);
}

constexpr std::string_view TwoProjectors = R"(
[[screen]]
name = "w"
lower_left = [-2, -1, -3]
lower_right = [2, -1, -3]
upper_left = [-2, 1, -3]
black = 0.01
[[output]]
name = "left"
size = [160, 100]
screen = "w"
projector = { position = [-0.8, 0, 0], look_at = [-0.8, 0, -3], throw = 1.5 }
[[output]]
name = "right"
size = [160, 100]
screen = "w"
projector = { position = [0.8, 0, 0], look_at = [0.8, 0, -3], throw = 1.5 }
)";

TEST(DisplayFile, ProjectorsOnOneScreenGetSoftEdgesWhereTheyOverlap) {
    scene::BlobStore blobs;
    const DisplayFile file = parse_display(TwoProjectors, "wall.toml", blobs);
    const auto values = [&](const display::Grid& grid) { return blobs.find(grid.values.hash)->as<float>(); };
    const display::Blend &left = file.display.outputs.at(0).blend, &right = file.display.outputs.at(1).blend;
    ASSERT_FALSE(left.weights.empty());
    // Pictures of 2 m with centres 1.6 m apart: 0.4 m or 32 of 160 pixels overlap; pixels coincide.
    const auto of_left = values(left.weights), of_right = values(right.weights);
    const auto lift = values(left.lift);
    const std::size_t row = 50 * 160;
    for (std::size_t x = 2; x < 30; ++x) {
        const float one = of_left[row + 128 + x], two = of_right[row + x];
        EXPECT_GT(one, 0.0f);
        EXPECT_GT(two, 0.0f);
        EXPECT_NEAR(one + two, 1.0f, 0.03f) << x;
        EXPECT_EQ(lift[row + 128 + x], 0.0f);
    }
    EXPECT_NEAR(lift[row + 60], 0.01f, 0.002f);
    EXPECT_EQ(of_left[row + 130] > of_left[row + 150], true);
}

TEST(DisplayFile, ExplicitSoftEdgesAreKept) {
    const std::string text =
        std::string(TwoProjectors) + "[[adjust]]\noutput = 'left'\nblend = { right = 32 }\n";
    const DisplayFile file = parsed(text);
    EXPECT_TRUE(file.display.outputs[0].blend.weights.empty());
    EXPECT_EQ(file.display.outputs[0].blend.right, 32.0);
    EXPECT_TRUE(file.display.outputs[1].blend.weights.empty());
}

}  // namespace

}  // namespace tessera::display_file

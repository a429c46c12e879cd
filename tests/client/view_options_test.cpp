// Shared by render and probe: views from options, cameras by name and number, the progress line.
#include "client/tools/view_options.h"

#include <gtest/gtest.h>

#include <limits>

#include "client/tools/frame_names.h"
#include "client/tools/progress_line.h"
#include "client/tools/render_options.h"

namespace tessera::tools {
namespace {

std::vector<import::CameraInfo> cameras() {
    return {{.name = "front"}, {.name = "Top view"}, {.name = "0"}};
}

TEST(Cameras, AreChosenByNameBeforeNumberAndFirstByDefault) {
    EXPECT_EQ(choose_camera(cameras(), std::nullopt)->name, "front");
    EXPECT_EQ(choose_camera(cameras(), "Top view")->name, "Top view");
    EXPECT_EQ(choose_camera(cameras(), "1")->name, "Top view");
    EXPECT_EQ(choose_camera(cameras(), "0")->name, "0");  // names take precedence over numbers
}

TEST(Cameras, UnknownCameraErrorListsAllAndSuggestsTheNearest) {
    const auto missing = choose_camera(cameras(), "frnt");
    ASSERT_FALSE(missing);
    const std::string message = missing.error().what();
    EXPECT_NE(message.find("did you mean 'front'"), std::string::npos) << message;
    EXPECT_NE(message.find("Top view"), std::string::npos) << message;
    for (const char* choice : {"3", "-1", "99999999999999999999", "1.0", ""}) {
        EXPECT_FALSE(choose_camera(cameras(), choice)) << choice;
    }
}

TEST(ViewOptions, AreConvertedToAView) {
    ViewOptions options{.scene = "a.glb",
                        .size = "64x32",
                        .bounces = 3,
                        .specular_bounces = 5,
                        .clamp = 2.5,
                        .pixel_filter = "gaussian",
                        .seed = 9};
    options.crop = "8,4,16,8";
    options.background = "0.25,0.5,1";
    const auto plan = parse_options(options);
    ASSERT_TRUE(plan) << plan.error().what();
    EXPECT_EQ(plan->view.width, 64u);
    EXPECT_EQ(plan->view.window, (Rect{8, 4, 16, 8}));
    EXPECT_EQ(plan->view.max_bounces, 3u);
    EXPECT_EQ(plan->view.max_specular_bounces, 5u);
    EXPECT_EQ(plan->view.clamp_indirect, 2.5f);
    EXPECT_EQ(plan->view.sky_cells_from, (1u << 18) / 128u) << "of the crop";
    EXPECT_EQ(plan->view.seed, 9u);
    EXPECT_EQ(plan->view.pixel_filter.kind, view::PixelFilterKind::Gaussian);
    EXPECT_EQ(plan->import.background, glm::vec3(0.25f, 0.5f, 1.0f));
    const view::View view = view_from(*plan, {.name = "c", .camera = {.vertical_fov = 1.0}});
    EXPECT_NEAR(view.camera.right / view.camera.top, 2.0, 1e-12);
}

TEST(ViewOptions, TheSkyIsSampledWhereItIsSeenOnceThatPays) {
    ViewOptions options{.scene = "a.glb", .size = "1000x1000"};
    EXPECT_EQ(parse_options(options)->view.sky_cells_from, 1u);
    options.size = "320x180";
    EXPECT_EQ(parse_options(options)->view.sky_cells_from, 5u);
    options.sky_sampling = "luminance";
    EXPECT_EQ(parse_options(options)->view.sky_cells_from, view::NoSkyCells);
}

TEST(ViewOptions, ErrorsNameTheOption) {
    ViewOptions options{.scene = "a.glb"};
    options.environment_strength = -1.0;
    EXPECT_NE(std::string(parse_options(options).error().what()).find("--env-strength"), std::string::npos);
    options = {.scene = "a.glb", .environment_rotation = INFINITY};
    EXPECT_NE(std::string(parse_options(options).error().what()).find("--env-rotation"), std::string::npos);
    for (const double clamp : {0.0, -1.0, 1e-60, 1e60, double(INFINITY), double(NAN)}) {
        options = {.scene = "a.glb", .clamp = clamp};
        EXPECT_NE(std::string(parse_options(options).error().what()).find("--clamp"), std::string::npos);
    }
    options = {.scene = "a.glb", .size = "12"};
    EXPECT_NE(std::string(parse_options(options).error().what()).find("--size"), std::string::npos);
    options = {.scene = "a.glb"};
    options.crop = "0,0,99999,1";
    EXPECT_NE(std::string(parse_options(options).error().what()).find("--crop"), std::string::npos);
}

TEST(ViewOptions, TooManyPixelsAreRejected) {
    ViewOptions options{.scene = "a.glb", .size = "16385x16384"};
    EXPECT_NE(std::string(parse_options(options).error().what()).find("--size: more than 2^28"),
              std::string::npos);
    options.crop = "0,0,16384,16384";
    EXPECT_TRUE(parse_options(options));
    RenderOptions coverage;
    coverage.coverage = true;
    coverage.view = {.scene = "a.glb", .size = "4000x4000"};
    coverage.spp = 64;
    const auto plan = parse_options(coverage);
    ASSERT_FALSE(plan);
    EXPECT_NE(std::string(plan.error().what()).find("--spp: each sample is a pixel"), std::string::npos);
}

RenderOptions sequence_options() {
    RenderOptions options;
    options.view.scene = "a.glb";
    options.outputs = {"out.%04d.png"};
    options.frames = "12:47";
    return options;
}

std::string error_text(const RenderOptions& options) {
    const auto plan = parse_options(options);
    return plan ? "none" : plan.error().what();
}

TEST(Sequences, StartAtTheTimeOfTheFirstFrame) {
    RenderOptions options = sequence_options();
    auto plan = parse_options(options);
    ASSERT_TRUE(plan) << plan.error().what();
    EXPECT_EQ(plan->sequence->frames.first, 12u);
    EXPECT_EQ(plan->sequence->frames.last, 47u);
    EXPECT_EQ(plan->view.import.at, 0.5) << "24 frames per second";
    EXPECT_EQ(plan->view.import.motion, import::Motion::Sequence);
    options.fps = 48.0;
    EXPECT_EQ(parse_options(options)->view.import.at, 0.25);
    options.frames.reset();
    options.fps.reset();
    EXPECT_FALSE(parse_options(options)->sequence);
}

TEST(Sequences, ConflictingOptionsAreRejected) {
    const auto contains = [](const std::string& text, const char* part) {
        return text.find(part) != std::string::npos ? testing::AssertionSuccess()
                                                    : testing::AssertionFailure() << text;
    };
    RenderOptions options = sequence_options();
    options.outputs = {"out.%04d.png", "out.exr"};
    EXPECT_TRUE(contains(error_text(options), "'out.exr' has no placeholder for the frame number"));
    for (const char* frames : {"3:2", "a:b", "1:2:3", "", "-1:2", "0:10000000"}) {
        options = sequence_options();
        options.frames = frames;
        EXPECT_TRUE(contains(error_text(options), "--frames")) << frames;
    }
    options = sequence_options();
    options.view.at = 1.0;
    EXPECT_TRUE(contains(error_text(options), "--at and --frames exclude"));
    options = sequence_options();
    options.fps = 0.0;
    EXPECT_TRUE(contains(error_text(options), "--fps"));
    options = sequence_options();
    options.frames.reset();
    options.skip_existing = true;
    EXPECT_TRUE(contains(error_text(options), "--frames A:B"));
    options.skip_existing = false;
    options.view.animation = "walk";
    EXPECT_TRUE(contains(error_text(options), "--animation"));
    options.view.at = std::numeric_limits<double>::quiet_NaN();
    EXPECT_TRUE(contains(error_text(options), "--at"));
}

TEST(Sequences, FrameNames) {
    EXPECT_EQ(frame_name("out.%04d.exr", 12), "out.0012.exr");
    EXPECT_EQ(frame_name("out.%04d.exr", 123456), "out.123456.exr");
    EXPECT_EQ(frame_name("%d/a.png", 7), "7/a.png");
    for (const char* wrong :
         {"out.exr", "%", "out.%04", "out.%4d.exr", "out.%00d.exr", "a%db%d", "%s", "%04d%%"}) {
        EXPECT_FALSE(frame_name(wrong, 1)) << wrong;
    }
}

TEST(ProgressText, ShowsFractionSamplesRaysAndTimeLeft) {
    session::ViewRequest request;
    request.view.window = {0, 0, 10, 10};
    request.stop.spp = 64;
    const session::ViewProgress progress{.phase = session::Phase::Rendering,
                                         .samples = 1600,
                                         .samples_expected = 6400,
                                         .rays = 20'000'000,
                                         .nodes = 2,
                                         .elapsed = std::chrono::seconds(10)};
    EXPECT_EQ(describe(progress, request), " 25 %   16 of 64 spp   2.0 Mrays/s   2 nodes   30 s left");
}

TEST(ProgressText, HandlesTheStartWithoutSamples) {
    session::ViewRequest request;
    request.view.window = {};
    request.stop.spp = 1;
    const session::ViewProgress nothing{.phase = session::Phase::Rendering};
    EXPECT_NE(describe(nothing, request).find("0 %"), std::string::npos);
    EXPECT_NE(describe({.phase = session::Phase::WaitingForNodes}, request).find("waiting"),
              std::string::npos);
}

}  // namespace
}  // namespace tessera::tools

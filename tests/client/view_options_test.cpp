// What render and probe have in common: views from options, cameras by name and number, the progress line.
#include "client/tools/view_options.h"

#include <gtest/gtest.h>

#include "client/tools/progress_line.h"

namespace tessera::tools {
namespace {

std::vector<import::CameraInfo> cameras() {
    return {{.name = "front"}, {.name = "Top view"}, {.name = "0"}};
}

TEST(Cameras, AreChosenByNameBeforeNumberAndFirstByDefault) {
    EXPECT_EQ(choose_camera(cameras(), std::nullopt)->name, "front");
    EXPECT_EQ(choose_camera(cameras(), "Top view")->name, "Top view");
    EXPECT_EQ(choose_camera(cameras(), "1")->name, "Top view");
    EXPECT_EQ(choose_camera(cameras(), "0")->name, "0");  // the name stands over the number
}

TEST(Cameras, AMissingOneIsAFailureThatListsAllAndNamesTheNearest) {
    const auto missing = choose_camera(cameras(), "frnt");
    ASSERT_FALSE(missing);
    const std::string message = missing.error().what();
    EXPECT_NE(message.find("did you mean 'front'"), std::string::npos) << message;
    EXPECT_NE(message.find("Top view"), std::string::npos) << message;
    for (const char* choice : {"3", "-1", "99999999999999999999", "1.0", ""}) {
        EXPECT_FALSE(choose_camera(cameras(), choice)) << choice;
    }
}

TEST(ViewOptions, BecomeAView) {
    ViewOptions options{
        .scene = "a.glb", .size = "64x32", .bounces = 3, .pixel_filter = "gaussian", .seed = 9};
    options.crop = "8,4,16,8";
    options.background = "0.25,0.5,1";
    const auto plan = understand(options);
    ASSERT_TRUE(plan) << plan.error().what();
    EXPECT_EQ(plan->view.width, 64u);
    EXPECT_EQ(plan->view.window, (Rect{8, 4, 16, 8}));
    EXPECT_EQ(plan->view.max_bounces, 3u);
    EXPECT_EQ(plan->view.seed, 9u);
    EXPECT_EQ(plan->view.pixel_filter.kind, view::PixelFilterKind::Gaussian);
    EXPECT_EQ(plan->import.background, glm::vec3(0.25f, 0.5f, 1.0f));
    const view::View view = view_from(*plan, {.name = "c", .vertical_fov = 1.0});
    EXPECT_NEAR(view.camera.right / view.camera.top, 2.0, 1e-12);
}

TEST(ViewOptions, AFailureNamesTheOption) {
    ViewOptions options{.scene = "a.glb"};
    options.environment_strength = -1.0;
    EXPECT_NE(std::string(understand(options).error().what()).find("--env-strength"), std::string::npos);
    options = {.scene = "a.glb", .size = "12"};
    EXPECT_NE(std::string(understand(options).error().what()).find("--size"), std::string::npos);
    options = {.scene = "a.glb"};
    options.crop = "0,0,99999,1";
    EXPECT_NE(std::string(understand(options).error().what()).find("--crop"), std::string::npos);
}

TEST(ProgressText, TellsShareSamplesRaysAndTimeLeft) {
    client::JobRequest request;
    request.view.window = {0, 0, 10, 10};
    request.spp = 64;
    const client::Progress progress{.phase = client::Phase::Rendering,
                                    .samples = 1600,
                                    .samples_expected = 6400,
                                    .rays = 20'000'000,
                                    .nodes = 2,
                                    .elapsed = std::chrono::seconds(10)};
    EXPECT_EQ(describe(progress, request), " 25 %   16 of 64 spp   2.0 Mrays/s   2 nodes   30 s left");
}

TEST(ProgressText, BearsAStartWithoutAnySample) {
    client::JobRequest request;
    request.view.window = {};
    request.spp = 1;
    const client::Progress nothing{.phase = client::Phase::Rendering};
    EXPECT_NE(describe(nothing, request).find("0 %"), std::string::npos);
    EXPECT_NE(describe({.phase = client::Phase::WaitingForNodes}, request).find("waiting"),
              std::string::npos);
}

}  // namespace
}  // namespace tessera::tools

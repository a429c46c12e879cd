// Requests that cannot be rendered are rejected with the reason.
#include <gtest/gtest.h>

#include <limits>

#include "master/render/view_request.h"

namespace tessera::master {
namespace {

session::ViewRequest request_with(const view::CameraPose& camera) {
    session::ViewRequest request;
    request.view.camera = camera;
    request.view.channels = {frame::Channel::Radiance};
    request.stop.spp = 1;
    request.film = true;
    return request;
}

bool is_refused_for(const view::CameraPose& camera, const std::string& part) {
    return problem_of(request_with(camera)).find(part) != std::string::npos;
}

TEST(RequestProblem, AcceptsValidCameras) {
    EXPECT_EQ(problem_of(request_with({})), "");
    EXPECT_EQ(problem_of(request_with({.lens_radius = 0.1, .focus_distance = 2.0})), "");
    EXPECT_EQ(problem_of(request_with({.focus_distance = 0.0})), "") << "a pinhole has no focus";
    EXPECT_EQ(problem_of(request_with({.left = -1e6, .projection = scene::Projection::Orthographic})), "");
}

TEST(RequestProblem, RejectsNoisesThatCannotBeReached) {
    session::ViewRequest request = request_with({});
    request.frames = session::Frames::Last;
    for (const double noise : {0.0, 1e-9, 0.02, 1.0}) {
        request.stop.noise = noise;
        EXPECT_EQ(problem_of(request), "") << noise;
    }
    for (const double noise :
         {-0.1, 1e7, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        request.stop.noise = noise;
        EXPECT_NE(problem_of(request).find("the noise to reach"), std::string::npos) << noise;
    }
    request.stop.noise = 0.02;
    request.frames = session::Frames::All;
    EXPECT_NE(problem_of(request).find("can stop at a noise"), std::string::npos);
}

TEST(RequestProblem, RejectsErrorsThatCannotBeReachedOrEstimated) {
    session::ViewRequest request = request_with({});
    request.frames = session::Frames::Last;
    for (const char* filter : {"", "none", "fdf", "nlm", "guided", "bilateral", "statmc:transform=none"}) {
        request.view.filter = filter;
        request.stop.error = 0.01;
        EXPECT_EQ(problem_of(request), "") << filter;
    }
    for (const double error :
         {-0.1, 1e7, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        request.stop.error = error;
        EXPECT_NE(problem_of(request).find("the error to reach"), std::string::npos) << error;
    }
    request.stop.error = 0.01;
    request.view.filter = "nfor";
    EXPECT_NE(problem_of(request).find("'nfor' reads 'first_half'"), std::string::npos);
    request.view.filter = "psvgf";
    EXPECT_NE(problem_of(request).find("'psvgf' has a history"), std::string::npos);
    request.view.filter = "fdf";
    request.stop.noise = 0.1;
    EXPECT_NE(problem_of(request).find("leave one out"), std::string::npos);
    request.stop.noise = 0.0;
    request.frames = session::Frames::All;
    EXPECT_NE(problem_of(request).find("can stop at a noise or an error"), std::string::npos);
}

TEST(RequestProblem, RejectsInvalidCameras) {
    constexpr double NaN = std::numeric_limits<double>::quiet_NaN(),
                     Infinity = std::numeric_limits<double>::infinity();
    for (const double radius : {-1.0, NaN, Infinity, 1e7})
        EXPECT_TRUE(is_refused_for({.lens_radius = radius}, "the lens radius")) << radius;
    for (const double focus : {-1.0, 0.0, 1e-9, NaN, Infinity})
        EXPECT_TRUE(is_refused_for({.lens_radius = 0.1, .focus_distance = focus}, "focus distance")) << focus;
    const std::vector<glm::dmat4> most(scene::MaxMotion, glm::dmat4(1.0));
    EXPECT_EQ(problem_of(request_with({.motion = most})), "");
    EXPECT_TRUE(is_refused_for({.motion = std::vector(scene::MaxMotion + 1, glm::dmat4(1.0))}, "steps"));
    EXPECT_TRUE(is_refused_for({.motion = {glm::dmat4(NaN)}}, "not finite"));
    EXPECT_TRUE(is_refused_for({.right = -2.0}, "empty frustum"));
    EXPECT_TRUE(is_refused_for({.right = 1e16, .projection = scene::Projection::Orthographic}, "wider than"));
}

// Requests are untrusted: they must not cost unbounded memory or overflow.
TEST(RequestProblem, RejectsExcessiveCostAndOverflow) {
    const auto problem = [](const auto& change) {
        session::ViewRequest request = request_with({});
        change(request);
        return problem_of(request);
    };
    EXPECT_NE(problem([](auto& r) { r.tile = 1; }).find("8 pixels"), std::string::npos);
    EXPECT_EQ(problem([](auto& r) { r.tile = 8; }), "");
    EXPECT_NE(problem([](auto& r) { r.stop.time_limit = Duration::max(); }).find("year"), std::string::npos);
    EXPECT_NE(problem([](auto& r) {
                  r.picture = session::PictureEncoding::Png;
                  r.stop.budget = Duration::max();
              }).find("year"),
              std::string::npos);
    EXPECT_NE(problem([](auto& r) { r.stop.time_limit = Duration::min(); }).find("negative"),
              std::string::npos);
    EXPECT_NE(problem([](auto& r) { r.stop.budget = Duration::min(); }).find("negative"), std::string::npos);
    EXPECT_NE(problem([](auto& r) { r.wait_limit = Duration(-1); }).find("negative"), std::string::npos);
    EXPECT_EQ(problem([](auto& r) { r.wait_limit = Duration::max(); }), "") << "compared, never added";
    EXPECT_NE(problem([](auto& r) { r.name = std::string(129, 'n'); }).find("128"), std::string::npos);
    EXPECT_NE(problem([](auto& r) { r.stop.spp = 0; }).find("2^31"), std::string::npos);
}

}  // namespace
}  // namespace tessera::master

// Whitted's tree of perfect speculars: the headlight feature and the renderer of that name.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using frame::Channel;
using view::View;

constexpr double Tilt = 0.8;
View from_above(double x = -1.0, std::uint32_t size = 16) {
    return small_view({x, 0.0, 1.0}, 0.3, size, glm::rotate(glm::dmat4(1.0), -Tilt, {0.0, 1.0, 0.0}));
}

// A plane in another plane's mirror: half of the albedo for the ambient light, half for the head light.
TEST(HeadlightFeature, FollowsAMirror) {
    Model model;
    model.floor(model.material(mirror({0.5f, 1.0f, 1.0f})), 10.0f, 0.0f);
    model.floor(model.material(chalk({0.8f, 0.6f, 0.2f})), -10.0f, 5.0f);
    SceneAdapter& world = model.build();
    View view = small_view({0.0, 0.0, 1.0}, 1e-4, 4, glm::rotate(glm::dmat4(1.0), -Tilt, {0.0, 1.0, 0.0}));
    view.channels = {Channel::Headlight};
    const double cosine = std::cos(Tilt), response = 0.5 * (1.0 + cosine);
    const double red_weight = 0.5 + 0.5 * std::pow(1.0 - cosine, 5.0);
    for_samples(world, view, 2, [&](const PathSample& sample) {
        EXPECT_NEAR(sample.headlight.x, red_weight * 0.8 * response, 1e-3);
        EXPECT_NEAR(sample.headlight.y, 0.6 * response, 1e-3);
        EXPECT_NEAR(sample.headlight.z, 0.2 * response, 1e-3);
    });
}

// A hall that is white inside, seen through a ball of glass: half is certain to be ambient light, less what
// MaxSpecularDepth and MinBranchWeight cut off.
TEST(HeadlightFeature, FollowsBothBranchesOfGlassAndStaysInBounds) {
    for (const float index : {1.01f, 1.5f, 2.4f}) {
        Model model;
        model.sphere(model.material(glass(index)), {0.0, 0.0, -3.0}, 1.0);
        model.sphere(model.material({.base_color = {1, 1, 1, 1}, .double_sided = true, .unlit = true}), {},
                     9.0);
        SceneAdapter& world = model.build();
        View view = small_view({}, 0.5, 32);
        view.channels = {Channel::Headlight};
        const Mean mean = mean_of(world, view, 2, [](const PathSample& sample) {
            EXPECT_LE(sample.headlight.x, 1.0f + 1e-5f);
            return double(sample.headlight.x);
        });
        EXPECT_GE(mean.value, 0.5) << index;
    }
}

TEST(HeadlightFeature, TheBackgroundAddsNothing) {
    Model model;
    model.floor(model.material(mirror(glm::vec3(0.9f))), 10.0f, 0.0f);
    model.sky(glm::vec3(1.0f));
    SceneAdapter& world = model.build();
    View view = from_above();
    view.channels = {Channel::Headlight};
    for_samples(world, view, 1,
                [&](const PathSample& sample) { EXPECT_EQ(sample.headlight, glm::vec3(0.0f)); });
}

// T14. Noise: the variance of a pixel's mean of 4 samples, over pixels, relative to the mean squared; of the
// headlight feature and of indirect light. The stripes on the wall are seen in the mirror.
TEST(HeadlightFeature, IsFreeOfNoiseAfterFourSamplesAndShowsTexturesInMirrors) {
    Model model;
    model.floor(model.material(mirror(glm::vec3(0.9f))), 10.0f, 0.0f);
    const ObjectId wall = model.material(chalk(glm::vec3(1.0f)));
    model.quad(wall, {{{5, -9, 0}, {5, 9, 0}, {5, 9, 9}, {5, -9, 9}}},
               {{0.2, 0.2, 0.2, 1}, {0.8, 0.8, 0.8, 1}, {0.8, 0.8, 0.8, 1}, {0.2, 0.2, 0.2, 1}});
    model.floor(model.material(chalk(glm::vec3(0.7f))), -10.0f, 9.0f);
    model.point_light({2.0, 0.0, 8.0}, 200.0f);
    SceneAdapter& world = model.build();
    View view = from_above(0.0, 32);
    view.max_bounces = 8;
    view.channels = {Channel::Headlight, Channel::HighVariance};
    const std::size_t pixels = std::size_t{view.width} * view.height;
    struct Sums {
        double headlight = 0, headlight2 = 0, indirect = 0, indirect2 = 0;
    };
    std::vector<Sums> sums(pixels);
    std::size_t i = 0;
    for_samples(world, view, 4, [&](const PathSample& sample) {
        Sums& sum = sums[i++ % pixels];
        sum.headlight += double(sample.headlight.x);
        sum.headlight2 += double(sample.headlight.x) * double(sample.headlight.x);
        sum.indirect += double(sample.high.x);
        sum.indirect2 += double(sample.high.x) * double(sample.high.x);
    });
    double headlight = 0, indirect = 0, headlight_mean = 0, indirect_mean = 0;
    double left = 0, right = 0;
    for (std::size_t p = 0; p < pixels; ++p) {
        const Sums& sum = sums[p];
        headlight += (sum.headlight2 - sum.headlight * sum.headlight / 4) / 3 / 4 / double(pixels);
        indirect += (sum.indirect2 - sum.indirect * sum.indirect / 4) / 3 / 4 / double(pixels);
        headlight_mean += sum.headlight / 4 / double(pixels);
        indirect_mean += sum.indirect / 4 / double(pixels);
        const std::size_t x = p % view.width;
        if (x < 4) left += sum.headlight;
        if (x >= view.width - 4) right += sum.headlight;
    }
    const double noise = headlight / (headlight_mean * headlight_mean),
                 path = indirect / (indirect_mean * indirect_mean);
    std::printf("relative variance after 4 samples: headlight %.2e, indirect %.2e\n", noise, path);
    EXPECT_LT(noise, 1e-3 * path);
    EXPECT_GT(headlight_mean, 0.05);
    const double contrast = std::fabs(left - right) / (left + right);
    EXPECT_GT(contrast, 0.02) << "the wall's colours, in the mirror";
}

// Without perfect speculars it is path tracing of direct light, to the bit.
TEST(Whitted, IsDirectLightWhereNothingIsPerfectlySpecular) {
    Model model;
    scene::Material varnished = chalk({0.7f, 0.5f, 0.2f});
    varnished.index_of_refraction = 1.5f;
    varnished.roughness = 0.3f;
    model.floor(model.material(varnished), 10.0f, 0.0f);
    model.quad(model.material(lamp(5.0f)), {{{1, -1, 0.5f}, {1, 1, 0.5f}, {1, 1, 2}, {1, -1, 2}}});
    model.sphere(model.material(varnished), {-0.3, 0.0, 0.3}, 0.3);
    model.sky(glm::vec3(0.3f));
    SceneAdapter& world = model.build();
    View view = from_above();
    view.max_bounces = 0;
    view.channels = frame::ChannelSet::all();
    std::vector<PathSample> paths;
    for_samples(world, view, 4, [&](const PathSample& sample) { paths.push_back(sample); });
    view.renderer = view::Renderer::Whitted;
    std::size_t i = 0;
    for_samples(world, view, 4, [&](const PathSample& sample) {
        const PathSample& path = paths[i++];
        EXPECT_EQ(radiance_of(sample), radiance_of(path));
        EXPECT_EQ(sample.albedo, path.albedo);
        EXPECT_EQ(sample.normal, path.normal);
        EXPECT_EQ(sample.depth, path.depth);
        EXPECT_EQ(sample.headlight, path.headlight);
        EXPECT_EQ(irradiance_of(sample), irradiance_of(path));
    });
}

// Through speculars it has path tracing's features in the mean, and no light of two scatterings.
TEST(Whitted, HasTheFeaturesOfPathTracing) {
    for (const float transmission : {1.0f, 0.5f}) {
        Model model;
        scene::Material ball = glass(1.5f, {0.9f, 0.9f, 0.5f});
        ball.transmission = transmission;
        ball.thickness = 1.0f;
        model.floor(model.material(chalk({0.7f, 0.5f, 0.2f})), 10.0f, -2.0f);
        model.sphere(model.material(ball), {}, 1.0);
        model.sky(glm::vec3(1.0f));
        SceneAdapter& world = model.build();
        View view = small_view({0.0, 0.0, 5.0}, 0.35);
        view.channels = frame::ChannelSet::all();
        View whitted = view;
        whitted.renderer = view::Renderer::Whitted;
        // What the tree does not follow: less than 1 / 512 at each of a handful of branches.
        constexpr double CutOff = 5.0 / 512.0;
        const auto expect_equal = [&](const std::function<double(const PathSample&)>& what) {
            const Mean a = mean_of(world, view, 128, what), b = mean_of(world, whitted, 32, what);
            EXPECT_NEAR(a.value, b.value, 4.0 * std::hypot(a.standard_error, b.standard_error) + CutOff);
            EXPECT_GT(a.value, 0.03);
        };
        expect_equal([](const PathSample& s) { return double(s.albedo.x); });
        expect_equal([](const PathSample& s) { return double(s.albedo.z); });
        expect_equal([](const PathSample& s) { return double(s.normal.z); });
        double high = 0.0;
        for_samples(world, whitted, 4, [&](const PathSample& s) { high += double(s.high.x); });
        EXPECT_EQ(high, 0.0);
    }
}

TEST(Whitted, SeesALampInAMirrorWithoutNoise) {
    Model model;
    model.floor(model.material(mirror({0.5f, 1.0f, 1.0f})), 10.0f, 0.0f);
    model.floor(model.material({.base_color = {4, 4, 4, 1}, .unlit = true}), -10.0f, 5.0f);
    SceneAdapter& world = model.build();
    View view = small_view({0.0, 0.0, 1.0}, 1e-4, 4, glm::rotate(glm::dmat4(1.0), -Tilt, {0.0, 1.0, 0.0}));
    view.renderer = view::Renderer::Whitted;
    const double expected = 4.0 * (0.5 + 0.5 * std::pow(1.0 - std::cos(Tilt), 5.0));
    for_samples(world, view, 2,
                [&](const PathSample& sample) { EXPECT_NEAR(radiance_of(sample).x, expected, 1e-3); });
}

}  // namespace
}  // namespace tessera::embree

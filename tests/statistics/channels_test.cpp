// What the filters are given: path classes, features, halves, each by its definition.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "mediator/shading/sample_values.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using frame::Channel;
using view::FeatureRule;
using view::PathClass;
using view::View;

constexpr frame::ChannelSet All = frame::ChannelSet::all();

// A coloured corner with a sphere of the given material under a lamp, open to the sky.
struct Corner : Model {
    explicit Corner(const scene::Material& sphere_material) {
        scene::Material varnished = chalk({0.7f, 0.5f, 0.2f});
        varnished.index_of_refraction = 1.5f;
        varnished.roughness = 0.4f;
        const ObjectId wall = material(varnished);
        floor(wall, 2.0f, 0.0f);
        quad(wall, {{{-2, -2, 0}, {-2, 2, 0}, {-2, 2, 4}, {-2, -2, 4}}});
        quad(material(lamp(6.0f)), {{{0, -1, 3}, {0, 1, 3}, {1, 1, 3}, {1, -1, 3}}});
        sphere(material(sphere_material), {0.2, 0.0, 0.8}, 0.7);
        sky({0.1f, 0.2f, 0.3f});
    }
    static View eye() {
        View view = small_view({0.0, -4.0, 2.0}, 1.0, 24, glm::rotate(glm::dmat4(1.0), 1.2, {1.0, 0.0, 0.0}));
        view.max_bounces = 8;
        view.channels = All;
        return view;
    }
};

double energy(const glm::vec3& color) {
    return double(color.x) + double(color.y) + double(color.z);
}

TEST(PathClasses, SumToTheRadiance) {
    Corner corner(glass(1.5f));
    SceneAdapter& world = corner.build();
    View view = Corner::eye();
    std::vector<glm::vec3> reference;
    for_samples(world, view, 2, [&](const PathSample& s) { reference.push_back(radiance_of(s)); });
    for (const PathClass kind :
         {PathClass::Indirect, PathClass::Caustics, PathClass::Diffuse, PathClass::All, PathClass::None}) {
        view.path_class = kind;
        std::size_t i = 0;
        double low = 0.0, high = 0.0;
        for_samples(world, view, 2, [&](const PathSample& sample) {
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(radiance_of(sample)[c], reference[i][c], 1e-5f * (1.0f + reference[i][c]));
                ASSERT_GE(sample.low[c], -1e-6f * reference[i][c]);
                ASSERT_GE(sample.high[c], 0.0f);
            }
            low += energy(sample.low);
            high += energy(sample.high);
            ++i;
        });
        if (kind == PathClass::All) {
            EXPECT_EQ(low, 0.0);
        }
        if (kind == PathClass::None) {
            EXPECT_EQ(high, 0.0);
        }
        if (kind != PathClass::All) {
            EXPECT_GT(low, 0.0);
        }
        if (kind != PathClass::None) {
            EXPECT_GT(high, 0.0);
        }
    }
}

TEST(PathClasses, IrradianceTimesAlbedoIsTheLightOfTheDiffuseLobe) {
    Corner corner(glass(1.5f, {0.9f, 1.0f, 0.8f}));
    SceneAdapter& world = corner.build();
    View view = Corner::eye();
    view.path_class = PathClass::Diffuse;
    std::size_t lit = 0;
    for_samples(world, view, 4, [&](const PathSample& sample) {
        const glm::vec3 product = irradiance_of(sample) * sample.albedo;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(product[c], sample.high[c], 1e-6f * (1.0f + sample.high[c]));
        lit += sample.high.x > 0.0f ? 1 : 0;
    });
    EXPECT_GT(lit, 500u);
}

// A diffuse floor under a sky of 1: the irradiance over pi, whatever the colour; 0 where there is no colour.
TEST(PathClasses, IrradianceIsIndependentOfAlbedo) {
    Model model;
    model.floor(model.material(chalk({0.8f, 0.25f, 0.0f})), 10.0f, 0.0f);
    model.sky(glm::vec3(3.0f));
    SceneAdapter& world = model.build();
    View view = small_view({0.0, 0.0, 1.0}, 0.5);
    view.channels = {Channel::Irradiance};
    for (int c = 0; c < 3; ++c) {
        const Mean mean =
            mean_of(world, view, 64, [&](const PathSample& s) { return double(irradiance_of(s)[c]); });
        EXPECT_NEAR(mean.value, c == 2 ? 0.0 : 3.0, 4.0 * mean.standard_error + 1e-5);
    }
}

double caustics(const scene::Material& sphere_material) {
    Corner corner(sphere_material);
    SceneAdapter& world = corner.build();
    View view = Corner::eye();
    view.path_class = PathClass::Caustics;
    double sum = 0.0;
    for_samples(world, view, 16, [&](const PathSample& sample) { sum += energy(sample.high); });
    return sum;
}

TEST(PathClasses, OnlyPerfectSpecularsCauseCaustics) {
    EXPECT_EQ(caustics(chalk({0.9f, 0.9f, 0.9f})), 0.0);
    EXPECT_GT(caustics(glass(1.5f)), 0.0);
    EXPECT_GT(caustics(mirror({0.9f, 0.9f, 0.9f})), 0.0);
}

// Seen in a mirror or not, one scattering is direct light, and light of the lamp itself is none.
TEST(PathClasses, PerfectSpecularsInFrontAreTransparent) {
    Model model;
    model.floor(model.material(mirror(glm::vec3(1.0f))), 10.0f, 0.0f);
    const ObjectId wall = model.material(chalk(glm::vec3(0.5f)));
    model.quad(wall, {{{4, -9, 0.1f}, {4, 9, 0.1f}, {4, 9, 9}, {4, -9, 9}}});
    model.point_light({0.0, 0.0, 3.0}, 10.0f);
    SceneAdapter& world = model.build();
    View view = small_view({0.0, 0.0, 2.0}, 0.2, 8, glm::rotate(glm::dmat4(1.0), -0.8, {0.0, 1.0, 0.0}));
    view.channels = All;
    view.max_bounces = 0;  // at the wall: the mirror does not count
    double light = 0.0;
    for_samples(world, view, 4, [&](const PathSample& sample) {
        EXPECT_EQ(sample.high, glm::vec3(0.0f));
        EXPECT_EQ(sample.albedo, glm::vec3(0.5f));
        EXPECT_NEAR(sample.normal.x, -1.0f, 1e-6f) << "of the wall";
        EXPECT_LT(sample.depth, 3.5f) << "of the mirror";
        light += energy(sample.low);
    });
    EXPECT_GT(light, 0.0);
}

// A white point-lit floor: by definition the feature is what the light is without the floor's colour, or the
// lamp's intensity.
TEST(ShadingFeature, MatchesAKnownScene) {
    for (const float albedo : {0.9f, 0.2f}) {
        Model model;
        model.floor(model.material(chalk({albedo, 0.5f * albedo, albedo})), 10.0f, 0.0f);
        model.point_light({0.0, 0.0, 2.0}, 50.0f);
        SceneAdapter& world = model.build();
        View view = small_view({0.0, 0.0, 1.0}, 1e-3, 4);
        view.channels = {Channel::ShadingFeature};
        for_samples(world, view, 1, [&](const PathSample& sample) {
            EXPECT_NEAR(shading_feature_of(sample, std::uint32_t(FeatureRule::Demodulated)),
                        50.0 / 4.0 / M_PI, 1e-3);
        });
        view.feature_rule = FeatureRule::Connections;
        for_samples(world, view, 1, [&](const PathSample& sample) {
            EXPECT_NEAR(shading_feature_of(sample, std::uint32_t(FeatureRule::Connections)), 50.0, 1e-3);
        });
    }
}

TEST(ShadingFeature, CountsTheSkyAsALight) {
    Model model;
    model.sky({1.0f, 2.0f, 3.0f});
    SceneAdapter& world = model.build();
    View view = small_view({}, 1.0, 4);
    view.channels = {Channel::ShadingFeature};
    for (const FeatureRule rule : {FeatureRule::Demodulated, FeatureRule::Connections}) {
        view.feature_rule = rule;
        for_samples(world, view, 1, [&](const PathSample& sample) {
            EXPECT_NEAR(shading_feature_of(sample, std::uint32_t(rule)), 0.299 + 2 * 0.587 + 3 * 0.114, 1e-5);
        });
    }
}

// LT27: the sky lights the scene and is seen in mirrors, but not by the camera.
TEST(TransparentBackground, AlphaIsZeroWithoutAHit) {
    Corner corner(mirror(glm::vec3(0.9f)));
    SceneAdapter& world = corner.build();
    View view = Corner::eye(), shown = view;
    view.transparent_background = true;
    std::vector<PathSample> samples;
    for_samples(world, shown, 2, [&](const PathSample& sample) { samples.push_back(sample); });
    std::size_t i = 0, misses = 0;
    for_samples(world, view, 2, [&](const PathSample& sample) {
        const bool miss = std::isinf(samples[i].depth);
        EXPECT_EQ(sample.alpha, miss ? 0.0f : 1.0f);
        EXPECT_EQ(radiance_of(sample), miss ? glm::vec3(0.0f) : radiance_of(samples[i]));
        if (miss) {
            EXPECT_EQ(radiance_of(samples[i]), glm::vec3(0.1f, 0.2f, 0.3f));
        }
        misses += miss ? 1 : 0;
        ++i;
    });
    EXPECT_GT(misses, 50u);
    EXPECT_GT(i - misses, 50u);
}

// The camera sees a colour where it sees nothing, and its alpha; mirrors show the light that there is.
TEST(VisibleBackground, IsVisibleToCameraRaysOnly) {
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        for (const float alpha : {0.0f, 0.5f, 1.0f}) {
            Corner corner(mirror(glm::vec3(0.9f))), other(mirror(glm::vec3(0.9f)));
            const glm::vec4 color(0.8f, 0.4f, 0.2f, alpha);
            corner.sky(scene::Background{.color = {0.1f, 0.2f, 0.3f},
                                         .visible = scene::VisibleBackground::Color,
                                         .visible_color = color});
            SceneAdapter& world = corner.build();
            View view = Corner::eye();
            view.renderer = renderer;
            std::vector<PathSample> samples;
            for_samples(other.build(), view, 2, [&](const PathSample& s) { samples.push_back(s); });
            std::size_t i = 0, misses = 0;
            for_samples(world, view, 2, [&](const PathSample& sample) {
                const bool miss = std::isinf(sample.depth);
                EXPECT_EQ(sample.alpha, miss ? alpha : 1.0f);
                EXPECT_EQ(radiance_of(sample), miss ? glm::vec3(color) * alpha : radiance_of(samples[i]));
                misses += miss ? 1 : 0;
                ++i;
            });
            EXPECT_GT(misses, 50u);
            EXPECT_GT(i - misses, 50u);
            View transparent = view;
            transparent.transparent_background = true;
            for_samples(world, transparent, 1, [&](const PathSample& sample) {
                if (!std::isinf(sample.depth)) return;
                EXPECT_EQ(sample.alpha, 0.0f);
                EXPECT_EQ(radiance_of(sample), glm::vec3(0.0f));
            });
        }
    }
}

std::vector<std::vector<float>> planes_of(const SceneAdapter& world, View view, Channel channel) {
    std::vector<std::vector<float>> result;
    const PathTracer tracer(world.tables(), world.scene(), view);
    std::uint64_t rays = 0;
    for (std::uint32_t i = 0; i < view.width * view.height; ++i) {
        const PathSample found = tracer.trace(i % view.width, i / view.width, 3, rays);
        const shading::SampleValues all = shading::sample_values(tracer.view(), found);
        std::size_t first = 0;
        for (const frame::ChannelInfo& info : frame::channel_table()) {
            if (info.channel == channel) break;
            first += view.channels.contains(info.channel) ? info.value_count() : 0;
        }
        const float* begin = all.items + first;
        result.emplace_back(begin, begin + frame::info(channel).value_count());
    }
    return result;
}

TEST(Channels, AreIndependentOfEachOther) {
    Corner corner(glass(1.5f));
    SceneAdapter& world = corner.build();
    for (const view::Renderer renderer : {view::Renderer::PathTracing, view::Renderer::Whitted}) {
        for (const PathClass kind : {PathClass::Indirect, PathClass::Diffuse}) {
            View together = Corner::eye();
            together.renderer = renderer;
            together.path_class = kind;
            for (const frame::ChannelInfo& info : frame::channel_table()) {
                if (!All.contains(info.channel) || info.is_derived()) continue;
                View alone = together;
                alone.channels = {info.channel};
                const auto a = planes_of(world, alone, info.channel);
                const auto b = planes_of(world, together, info.channel);
                for (std::size_t i = 0; i < a.size(); ++i) {
                    ASSERT_EQ(std::memcmp(a[i].data(), b[i].data(), 4 * a[i].size()), 0)
                        << info.name << " " << i;
                }
            }
        }
    }
}

// Box-Cox transform of the exponent 1/2, of each sample.
TEST(Channels, RootIsTheTransformOfEachSample) {
    Corner corner(glass(1.5f));
    SceneAdapter& world = corner.build();
    const auto radiance = planes_of(world, Corner::eye(), Channel::Radiance);
    const auto root = planes_of(world, Corner::eye(), Channel::Root);
    std::size_t bright = 0;
    for (std::size_t i = 0; i < root.size(); ++i) {
        ASSERT_EQ(root[i].size(), 3u);
        for (std::size_t c = 0; c < 3; ++c) {
            const double expected = 2.0 * (std::sqrt(std::max(double(radiance[i][c]), 0.0)) - 1.0);
            ASSERT_NEAR(root[i][c], expected, 1e-6 * (2.0 + std::abs(expected)));
            bright += radiance[i][c] > 1.0f ? 1 : 0;
        }
    }
    EXPECT_GT(bright, 0u);
    EXPECT_EQ(shading::root_of(0.0f), -2.0f);
    EXPECT_EQ(shading::root_of(-1.0f), -2.0f);
    EXPECT_EQ(shading::root_of(0.25f), -1.0f);
    EXPECT_TRUE(std::isinf(shading::root_of(shading::infinity())));
}

std::uint64_t rays_of(const SceneAdapter& world, const View& view) {
    const PathTracer tracer(world.tables(), world.scene(), view);
    std::uint64_t rays = 0;
    for (std::uint32_t i = 0; i < view.width * view.height; ++i)
        tracer.trace(i % view.width, i / view.width, 0, rays);
    return rays;
}

TEST(Channels, OnlyTheHeadlightFeatureThroughSpecularsCostsRays) {
    constexpr auto WithoutHeadlight = All - frame::ChannelSet{Channel::Headlight};
    for (const scene::Material& sphere_material : {glass(1.5f), chalk(glm::vec3(0.5f))}) {
        Corner corner(sphere_material);
        SceneAdapter& world = corner.build();
        View view = Corner::eye();
        view.channels = {Channel::Radiance};
        const std::uint64_t plain = rays_of(world, view);
        view.channels = WithoutHeadlight;
        EXPECT_EQ(rays_of(world, view), plain);
        view.channels = All;
        if (sphere_material.transmission > 0.0f) {
            EXPECT_GT(rays_of(world, view), plain);
        }
        if (sphere_material.transmission == 0.0f) {
            EXPECT_EQ(rays_of(world, view), plain) << "the first hit is reused";
        }
    }
}

}  // namespace
}  // namespace tessera::embree

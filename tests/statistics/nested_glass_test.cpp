// Nested glass: each boundary refracts and reflects according to the indices on both sides.
#include <gtest/gtest.h>

#include <cmath>
#include <initializer_list>
#include <utility>
#include <vector>

#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

using glm::vec3;

// Fresnel reflectance of unpolarised light at a boundary.
double reflectance(double from, double to, double angle = 0.0) {
    const double cosine = std::cos(angle), sine = from / to * std::sin(angle);
    if (sine >= 1.0) return 1.0;
    const double other = std::sqrt(1.0 - sine * sine);
    const double across = (from * cosine - to * other) / (from * cosine + to * other);
    const double parallel = (to * cosine - from * other) / (to * cosine + from * other);
    return 0.5 * (across * across + parallel * parallel);
}

// Transmittance at normal incidence through these media in sequence, with all orders of internal reflection.
double passed(std::initializer_list<double> indices) {
    double sum = 0.0;
    for (auto next = indices.begin() + 1; next != indices.end(); ++next) {
        const double r = reflectance(*(next - 1), *next);
        sum += r / (1.0 - r);
    }
    return 1.0 / (1.0 + sum);
}

// Radiance of a lamp seen from between two stacks of boundaries with these transmittances, including multiple
// reflections between them.
double seen_between(double below, double above) {
    return below / (1.0 - (1.0 - below) * (1.0 - above));
}

// Reflects nothing.
scene::Material black(float radiance) {
    return {.base_color = {0, 0, 0, 1}, .emission = vec3(radiance), .index_of_refraction = 1.0f};
}

// A path finds the lamp, of radiance 1, or not.
void expect_fraction(const SceneAdapter& world, const view::View& view, double fraction) {
    constexpr std::uint64_t Samples = 400;
    const Mean mean = mean_of(world, view, Samples, red);
    const double error =
        std::sqrt(std::max(fraction * (1.0 - fraction), 1e-9) / double(Samples * view.width * view.height));
    EXPECT_LE(error, 0.003);
    EXPECT_NEAR(mean.value, fraction, 4.5 * error + 1e-6);
}

view::View nested_from_above(double height = 10.0) {
    return small_view({0.01, 0.02, height}, 1e-4, 16);
}

TEST(NestedGlass, NestedLayersTransmitTheProductOfTheirBoundaries) {
    const std::vector<std::pair<float, float>> pairs{{1.5f, 1.33f}, {1.33f, 1.5f},     {1.5f, 1.0f},
                                                     {1.5f, 1.5f},  {1.5f, 1.500002f}, {1.2f, 4.0f},
                                                     {1.0f, 2.0f}};
    for (const auto& [outer, inner] : pairs) {
        SCOPED_TRACE(testing::Message() << outer << " " << inner);
        Model model;
        model.box(model.material(glass(outer)), {-1, -1, 0}, {1, 1, 4});
        model.box(model.material(glass(inner)), {-0.5f, -0.5f, 1}, {0.5f, 0.5f, 3});
        model.floor(model.material(black(1.0f)), 10.0f, -5.0f);
        const SceneAdapter& world = model.build();
        EXPECT_TRUE(model.problems.empty());
        expect_fraction(world, nested_from_above(), passed({1.0, outer, inner, outer, 1.0}));
        // The eye in the outer medium, above the inner one; then in the inner one.
        expect_fraction(world, nested_from_above(3.5),
                        seen_between(passed({outer, inner, outer, 1.0}), passed({outer, 1.0})));
        const double half = passed({inner, outer, 1.0});
        expect_fraction(world, nested_from_above(2.0), seen_between(half, half));
    }
}

// Where media overlap, the one of higher priority continues, and the other one's boundary is ignored.
TEST(NestedGlass, ThePriorityDecidesWhichBoundaryCounts) {
    for (const std::int32_t lower : {0, 1}) {
        Model model;
        model.set_medium({.priority = lower});
        model.box(model.material(glass(1.4f)), {-1, -1, 0}, {1, 1, 4});
        model.set_medium({.priority = 1 - lower});
        model.box(model.material(glass(1.9f)), {-0.5f, -0.5f, 2}, {0.5f, 0.5f, 6});
        model.clear_medium();
        model.floor(model.material(black(1.0f)), 10.0f, -5.0f);
        const SceneAdapter& world = model.build();
        expect_fraction(world, nested_from_above(), passed({1.0, 1.4, 1.9, 1.0}));
        // In the overlap, between the boundary that counts and that of the lower or upper medium.
        const double below = lower == 1 ? passed({1.4, 1.0}) : passed({1.9, 1.4, 1.0});
        const double above = lower == 1 ? passed({1.4, 1.9, 1.0}) : passed({1.9, 1.0});
        expect_fraction(world, nested_from_above(3.0), seen_between(below, above));
    }
}

// At equal priority the medium entered last wins: light down and light up find different boundaries.
TEST(NestedGlass, AtEqualPriorityTheLastEnteredWins) {
    Model model;
    model.box(model.material(glass(1.4f)), {-1, -1, 0}, {1, 1, 4});
    model.box(model.material(glass(1.9f)), {-0.5f, -0.5f, 2}, {0.5f, 0.5f, 6});
    model.floor(model.material(black(1.0f)), 10.0f, -5.0f);
    expect_fraction(model.build(), nested_from_above(), passed({1.0, 1.9, 1.4, 1.0}));
}

// Fog has no index: glass in it refracts as in the medium around the fog.
TEST(NestedGlass, FogHasNoIndexOfRefraction) {
    Model model;
    model.box(model.material(glass(1.5f)), {-2, -2, 0}, {2, 2, 6});
    model.set_medium({.absorption = vec3(1e-9f)});
    model.box(ObjectId{}, {-1, -1, 1}, {1, 1, 5});
    model.clear_medium();
    model.box(model.material(glass(1.2f)), {-0.5f, -0.5f, 2}, {0.5f, 0.5f, 4});
    model.floor(model.material(black(1.0f)), 10.0f, -5.0f);
    expect_fraction(model.build(), nested_from_above(), passed({1.0, 1.5, 1.2, 1.5, 1.0}));
}

// At an angle, from the outer medium onto the top of the inner one; reflected light ends at a black lid.
TEST(NestedGlass, FollowsFresnelAtEveryAngle) {
    struct Question {
        float outer, inner;
        double degrees;
    };
    std::vector<Question> questions;
    for (const double degrees : {10.0, 45.0, 80.0, 89.0}) {
        questions.push_back({1.33f, 1.5f, degrees});
        questions.push_back({1.5f, 1.5f * (1.0f + 1e-6f), degrees});
        questions.push_back({1.5f * (1.0f + 1e-6f), 1.5f, degrees});
    }
    // Around total reflection, at 62.457 degrees.
    for (const double degrees : {30.0, 62.0, 62.4, 62.5, 80.0}) questions.push_back({1.5f, 1.33f, degrees});
    for (const Question& question : questions) {
        SCOPED_TRACE(testing::Message()
                     << question.outer << " " << question.inner << " " << question.degrees);
        Model model;
        model.box(model.material(glass(question.outer)), {-500, -500, -10}, {500, 500, 10});
        model.box(model.material(glass(question.inner)), {-400, -400, -9}, {400, 400, 0});
        model.floor(model.material(black(1.0f)), 300.0f, -1.0f);
        model.floor(model.material(black(0.0f)), -300.0f, 2.0f);
        const SceneAdapter& world = model.build();
        const double angle = question.degrees * M_PI / 180.0;
        const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), angle, glm::dvec3(1, 0, 0));
        const view::View view = small_view({0.01, 0.02, 1.0}, 1e-5, 16, turn);
        expect_fraction(world, view, 1.0 - reflectance(question.outer, question.inner, angle));
    }
}

// The same boundary, twice: light refracted into and out of the inner medium keeps its direction.
TEST(NestedGlass, AnIndexMatchedMediumIsInvisible) {
    const auto pictures = [](bool nested) {
        Model model;
        model.sphere(model.material(glass(1.5f)), {0, 0, 0}, 1.0, Normals::Smooth);
        if (nested) model.sphere(model.material(glass(1.5f)), {0.1, 0.2, 0.1}, 0.5, Normals::Smooth);
        model.floor(model.material(black(1.0f)), 2.0f, -1.5f,
                    {{1, 1, 1, 1}, {0, 0, 0, 1}, {1, 1, 1, 1}, {0, 0, 0, 1}});
        model.sky(vec3(0.25f));
        view::View view = small_view({0.3, 0.2, 5}, 0.5, 24);
        view.renderer = view::Renderer::Whitted;
        std::vector<double> values;
        for_samples(model.build(), view, 1, [&](const PathSample& sample) { values.push_back(red(sample)); });
        return values;
    };
    const std::vector<double> with = pictures(true), without = pictures(false);
    ASSERT_EQ(with.size(), without.size());
    // Whitted's trees end after eight vertices, of which the inner medium uses some that carry no light.
    for (std::size_t i = 0; i < with.size(); ++i) EXPECT_NEAR(with[i], without[i], 0.02) << i;
}

// From both sides; index 0 means infinite.
TEST(NestedGlass, AnInfiniteIndexReflectsEverything) {
    for (const auto& [outer, inner] : {std::pair(1.5f, 0.0f), std::pair(0.0f, 1.5f)}) {
        Model model;
        model.box(model.material(glass(outer)), {-1, -1, 0}, {1, 1, 4});
        model.box(model.material(glass(inner)), {-0.5f, -0.5f, 1}, {0.5f, 0.5f, 3});
        model.floor(model.material(black(1.0f)), 0.4f, 2.0f);
        model.floor(model.material(black(0.0f)), -0.4f, 3.9f);
        expect_fraction(model.build(), nested_from_above(3.5), 0.0);
    }
}

}  // namespace
}  // namespace tessera::embree

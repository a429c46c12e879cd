// Where shading normals and flat triangles disagree: silhouettes, the terminator of coarse meshes, normal maps.
#include "mediator/shading/shading_normals.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mediator/base/random.h"
#include "mediator/shading/sampling.h"
#include "tests/statistics/model.h"

namespace tessera::embree {
namespace {

glm::vec3 unit_on_sphere(CounterRandom& random) {
    return shading::sample_sphere(glm::vec2(float(random.uniform()), float(random.uniform())) * 0.99999994f);
}

double mirrored_height(const glm::dvec3& normal, const glm::dvec3& up, const glm::dvec3& viewer) {
    return 2.0 * glm::dot(normal, viewer) * glm::dot(normal, up) - glm::dot(viewer, up);
}

struct Seen {
    glm::vec3 normal, up, viewer;
};
// Every second one at a grazing angle, down to 1e-7.
Seen random_place(CounterRandom& random, bool grazing) {
    Seen seen{unit_on_sphere(random), unit_on_sphere(random), unit_on_sphere(random)};
    if (grazing) {
        const float height = std::pow(10.0f, -7.0f * float(random.uniform()));
        seen.viewer = glm::normalize(seen.viewer - seen.up * (glm::dot(seen.viewer, seen.up) - height));
    }
    if (glm::dot(seen.up, seen.viewer) < 0.0f) seen.up = -seen.up;
    return seen;
}

TEST(SeenNormal, FacesTheViewer) {
    CounterRandom random(5);
    for (int i = 0; i < 200'000; ++i) {
        const Seen place = random_place(random, i % 2 == 0);
        const double height = double(glm::dot(place.viewer, place.up));
        if (!(height > 0.0)) continue;
        const glm::vec3 face = i % 3 == 0 ? -place.up : place.up;
        const glm::vec3 seen = shading::seen_normal(place.normal, face, -place.viewer);
        ASSERT_NEAR(glm::length(seen), 1.0f, 1e-5f);
        const double least = std::min(0.5 * height, double(shading::LeastTurnedCosine));
        ASSERT_NEAR(std::min(double(glm::dot(seen, place.viewer)) - least, 0.0), 0.0, 1e-6) << i;
        ASSERT_GE(glm::dot(seen, place.up), -1e-6f) << i;
        const glm::vec3 near = glm::dot(place.normal, place.up) < 0.0f ? -place.normal : place.normal;
        if (double(glm::dot(near, place.viewer)) > least + 1e-6) {
            ASSERT_EQ(seen, near) << i;
        } else if (height > 1e-4) {
            ASSERT_NEAR(glm::dot(seen, place.viewer), least, 2e-6) << i << ": no further than needed";
        }
    }
}

TEST(MirroringNormal, MirrorsTheViewerAboveTheFace) {
    CounterRandom random(5);
    for (int i = 0; i < 200'000; ++i) {
        const Seen place = random_place(random, i % 2 == 0);
        const double height = double(glm::dot(place.viewer, place.up));
        if (!(height > 0.0)) continue;
        const glm::vec3 normal = shading::seen_normal(place.normal, place.up, -place.viewer);
        const glm::vec3 found = shading::mirroring_normal(normal, place.up, -place.viewer);
        ASSERT_NEAR(glm::length(found), 1.0f, 1e-5f);
        const double least = std::min(0.5 * height, double(shading::LeastTurnedCosine));
        // A mirrored ray of this height is off by what rounding makes of it, and never below the face.
        ASSERT_GT(mirrored_height(found, place.up, place.viewer), least > 1e-3 ? least - 2e-5 : -1e-7) << i;
        if (mirrored_height(normal, place.up, place.viewer) > least + 1e-5) {
            ASSERT_EQ(found, normal) << i;
        }
    }
}

// A step of the normal by 1e-4 turns the results by at most a few times as much, also where the normal starts to be
// turned.
TEST(SeenNormal, IsContinuous) {
    CounterRandom random(6);
    for (int i = 0; i < 100'000; ++i) {
        const Seen place = random_place(random, false);
        if (std::fabs(glm::dot(place.normal, place.up)) < 0.05f) continue;  // there it turns over
        if (glm::dot(place.viewer, place.up) < 0.05f) continue;
        const glm::vec3 step = 1e-4f * unit_on_sphere(random);
        const auto result = [&](const glm::vec3& normal, bool mirrors) {
            const glm::vec3 seen = shading::seen_normal(normal, place.up, -place.viewer);
            return mirrors ? shading::mirroring_normal(seen, place.up, -place.viewer) : seen;
        };
        for (const bool mirrors : {false, true}) {
            const glm::vec3 one = result(place.normal, mirrors);
            const glm::vec3 other = result(glm::normalize(place.normal + step), mirrors);
            ASSERT_LT(glm::distance(one, other), 5e-3f) << i << " " << mirrors;
        }
    }
}

constexpr unsigned Coarse = 6;  // rings: 120 triangles, 30 degrees between their normals

// A white ball in front of a white sky is invisible, however coarse it is.
TEST(SmoothMesh, LosesNoLight) {
    Model model;
    model.sky(glm::vec3(1.0f));
    model.sphere(model.material(chalk(glm::vec3(1.0f))), {}, 1.0, Normals::Smooth, Coarse);
    const Mean mean = mean_of(model.build(), small_view({0.0, 0.0, 3.0}, 0.6, 32), 64, red);
    EXPECT_NEAR(mean.value, 1.0, 4.0 * mean.standard_error + 1e-3);
}

// A coarse ball that is lit from the side: every sample has Lambert's light by the shading normal, up to the
// terminator in the middle of the picture. No flat triangle is in the way.
TEST(SmoothMesh, HasItsTerminatorWhereTheShadingNormalHasIt) {
    Model model;
    model.light({.kind = scene::LightKind::Directional, .intensity = glm::vec3(3.0f)},
                glm::rotate(glm::dmat4(1.0), glm::radians(90.0), {0.0, 1.0, 0.0}));
    model.sphere(model.material(chalk(glm::vec3(1.0f))), {}, 1.0, Normals::Smooth, Coarse);
    view::View view = small_view({0.0, 0.0, 8.0}, 0.2, 32);
    view.max_bounces = 0;
    int samples = 0, darker = 0, near = 0;
    for_samples(model.build(), view, 64, [&](const PathSample& sample) {
        const double cosine = std::max(0.0, double(sample.normal.x));
        near += cosine > 0.0 && cosine < 0.1 ? 1 : 0;
        darker += std::fabs(red(sample) - cosine * 3.0 / M_PI) > 1e-4 ? 1 : 0;
        ++samples;
    });
    EXPECT_GT(near, samples / 50) << "the terminator is seen";
    EXPECT_EQ(darker, 0) << "of " << samples;
}

// What a normal map turns below the face is lost: (1 - cos) / 2 of a diffuse lobe that is tilted by this angle.
TEST(NormalMap, LosesWhatLeadsBelowTheFace) {
    Model model;
    model.sky(glm::vec3(1.0f));
    scene::Material material = chalk(glm::vec3(1.0f));
    material.normal_texture = model.texture<std::uint8_t>({.width = 1, .height = 1}, {204, 102, 255, 255});
    model.textured_quad(model.material(material), {{{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}}, 1.0f);
    const Mean mean = mean_of(model.build(), small_view({0.0, 0.0, 1.0}, 0.1), 1024, red);
    const double cosine = 1.0 / std::sqrt(1.0 + 0.6 * 0.6 + 0.2 * 0.2);
    EXPECT_NEAR(mean.value, 0.5 + 0.5 * cosine, 4.0 * mean.standard_error + 1e-4);
}

// Boxes with mean normals stand for no smooth surface: nothing is lifted off their faces.
TEST(SmoothMesh, IsNoBoxWithMeanNormals) {
    const glm::vec3 normals[] = {glm::normalize(glm::vec3(-1, -1, 1)), glm::normalize(glm::vec3(1, -1, 1)),
                                 glm::normalize(glm::vec3(1, 1, 1))};
    const shading::Triangle triangle{{-1, -1, 1}, {1, -1, 1}, {1, 1, 1}};
    EXPECT_EQ(shading::smooth_lift(triangle, normals[0], normals[1], normals[2], {0.3f, 0.3f}, 1.0f),
              glm::vec3(0.0f));
}

// In the middle of a sphere's chord of 30 degrees each tangent plane is sin^2 of half the angle above it. At any
// scale; from inside there is nothing to lift.
TEST(SmoothMesh, IsLiftedToTheTangentPlanes) {
    for (const float radius : {1e-6f, 1.0f, 1e6f}) {
        const double half = glm::radians(15.0);
        const glm::vec3 left(-float(std::sin(half)), 0.0f, float(std::cos(half)));
        const glm::vec3 right(-left.x, 0.0f, left.z);
        const shading::Triangle triangle{left * radius, right * radius,
                                         (right + glm::vec3(0, 1, 0)) * radius};
        const glm::vec3 lift = shading::smooth_lift(triangle, left, right, right, {0.5f, 0.0f}, 1.0f);
        const double expected = std::sin(half) * std::sin(half) * std::cos(half);
        EXPECT_NEAR(lift.z / radius, expected, 1e-6) << radius;
        EXPECT_NEAR(lift.x / radius, 0.0, 1e-6) << radius;
        EXPECT_EQ(shading::smooth_lift(triangle, left, right, right, {0.5f, 0.0f}, -1.0f), glm::vec3(0.0f));
    }
}

}  // namespace
}  // namespace tessera::embree

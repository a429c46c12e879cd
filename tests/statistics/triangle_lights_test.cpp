// Triangles of mesh lights sampled by solid angle: the angle, the distribution of samples, the variance, and that
// light is the same however it is found.
#include "mediator/shading/triangle_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "mediator/shading/lights.h"
#include "tests/statistics/chi_squared.h"
#include "tests/statistics/panels.h"

namespace tessera::embree {
namespace {

using shading::Triangle;
using shading::TriangleView;

struct TriangleCase {
    const char* name;
    glm::dvec3 p, q, r;  // seen from the origin
};

const TriangleCase TriangleCases[] = {{"above", {-1, -1, 1}, {1, -1, 1}, {0, 1, 1}},
                                      {"close", {-1, -0.6, 0.05}, {1, -0.5, 0.05}, {0.2, 1, 0.05}},
                                      {"over a corner", {0, 0, 0.5}, {1, 0.2, 0.5}, {0.1, 1, 0.6}},
                                      {"to the side", {1, 0, 0.5}, {2, 0.1, 0.5}, {1.4, 1, 0.7}},
                                      {"tilted", {0.2, 0.1, 0.3}, {0.9, 0.3, 1.2}, {0.1, 0.8, 0.5}},
                                      {"a strip", {-2, 0.3, 0.5}, {2, 0.3, 0.5}, {2, 0.45, 0.5}}};

shading::Instance at_rest() {
    shading::Instance instance{};
    instance.linear = glm::mat3(1.0f);
    return instance;
}

double area_of(const TriangleCase& c) {
    return 0.5 * glm::length(glm::cross(c.q - c.p, c.r - c.p));
}

TriangleView seen_from(const TriangleCase& c, double size, const glm::dvec3& from = {}) {
    const Triangle triangle{glm::vec3(size * (c.p + from)), glm::vec3(size * (c.q + from)),
                            glm::vec3(size * (c.r + from))};
    return view_triangle(at_rest(), triangle, float(1.0 / (size * std::sqrt(area_of(c)))),
                         glm::vec3(size * from));
}

double solid_angle(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& r) {
    const glm::dvec3 a = glm::normalize(p), b = glm::normalize(q), c = glm::normalize(r);
    return 2.0 * std::atan2(std::fabs(glm::dot(a, glm::cross(b, c))),
                            1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
}

TEST(TriangleLights, SolidAnglesMatchDoublePrecision) {
    for (const double size : {1e-15, 1e-6, 1.0, 1e12}) {
        for (const TriangleCase& c : TriangleCases) {
            EXPECT_NEAR(seen_from(c, size).solid_angle, solid_angle(c.p, c.q, c.r), 4e-6)
                << c.name << " " << size;
        }
    }
    const TriangleCase far{"far", {-1, -1, 30}, {1, -1, 30}, {0, 1, 30}};
    const TriangleCase edge_on{"edge-on", {1, -1, 0}, {1, 1, 0}, {2, 0, 0}};
    const TriangleCase touched{"touched", {0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    for (const TriangleCase& c : {far, edge_on, touched})
        EXPECT_EQ(seen_from(c, 1.0).solid_angle, 0.0f) << c.name;
}

// As many samples in each of 36 parts as its fraction of the solid angle; 10,000 sizes from the origin as well.
TEST(TriangleLights, SamplesAreUniformOverTheSolidAngle) {
    constexpr int Parts = 6, Count = 100'000;
    for (const double away : {0.0, 1e4}) {
        for (const TriangleCase& c : TriangleCases) {
            SCOPED_TRACE(testing::Message() << c.name << " " << away);
            const TriangleView seen = seen_from(c, 1.0, glm::dvec3(away, 0.5 * away, -away));
            ASSERT_GT(seen.solid_angle, 0.0f);
            const auto place = [&](int i, int j) {
                return c.p + (c.q - c.p) * (double(i) / Parts) + (c.r - c.p) * (double(j) / Parts);
            };
            std::vector<double> observed(2 * Parts * Parts), expected(2 * Parts * Parts);
            for (int i = 0; i < Parts; ++i) {
                for (int j = 0; i + j < Parts; ++j) {
                    const auto cell = std::size_t(2 * (i * Parts + j));
                    expected[cell] = solid_angle(place(i, j), place(i + 1, j), place(i, j + 1));
                    if (i + j + 1 < Parts)
                        expected[cell + 1] =
                            solid_angle(place(i + 1, j), place(i + 1, j + 1), place(i, j + 1));
                }
            }
            const double all = solid_angle(c.p, c.q, c.r);
            for (double& part : expected) part *= Count / all;
            CounterRandom random(31);
            for (int i = 0; i < Count; ++i) {
                const glm::vec2 u(float(random.uniform()) * 0.99999994f,
                                  float(random.uniform()) * 0.99999994f);
                const glm::vec2 b = sample_triangle_light(seen, u);
                ASSERT_TRUE(b.x >= 0.0f && b.y >= 0.0f && b.x + b.y <= 1.000001f);
                const double x = double(b.x) * Parts, y = double(b.y) * Parts;
                const int column = std::min(int(x), Parts - 1), row = std::min(int(y), Parts - 1 - column);
                const bool second = x - column + (y - row) > 1.0 && column + row + 1 < Parts;
                ++observed[std::size_t(2 * (column * Parts + row)) + (second ? 1u : 0u)];
            }
            test::expect_fit(observed, expected);
        }
    }
}

// Irradiance of the ground below: both estimates have Lambert's mean.
TEST(TriangleLights, SolidAngleSamplingReducesVarianceNearby) {
    for (const TriangleCase& c : TriangleCases) {
        const TriangleView seen = seen_from(c, 1.0);
        TriangleView flat = seen;
        flat.solid_angle = 0.0f;
        const float inverse_root_area = float(1.0 / std::sqrt(area_of(c)));
        const glm::dvec3 normal = glm::normalize(glm::cross(c.q - c.p, c.r - c.p));
        const auto estimate = [&](const TriangleView& view) {
            return mean_over_square([&](const glm::vec2& u) {
                const glm::vec2 b = sample_triangle_light(view, u);
                const glm::dvec3 point = c.p + (c.q - c.p) * double(b.x) + (c.r - c.p) * double(b.y);
                const double distance = glm::length(point);
                const double facing = std::fabs(glm::dot(point, normal)) / distance;
                return point.z / distance /
                       double(triangle_pdf(view, inverse_root_area, float(distance), float(facing)));
            });
        };
        const double exact = irradiance_of({{glm::vec3(c.p), glm::vec3(c.q), glm::vec3(c.r)}});
        const auto [mean, by_angle] = estimate(seen);
        const double by_area = estimate(flat).standard_error;
        std::printf("%-14s variance by solid angle / by area: %.3f\n", c.name,
                    by_angle * by_angle / (by_area * by_area));
        EXPECT_NEAR(mean, exact, 4.5 * by_angle + 1e-5 * exact) << c.name;
        EXPECT_LT(by_angle, by_area) << c.name;
    }
}

// A tilted lamp of 1.5 x 1.5 m, 3 m above the ground, seen from all around: closed form.
TEST(TriangleLights, HaveLambertsIrradiance) {
    const glm::dmat4 turn =
        glm::rotate(glm::rotate(glm::dmat4(1.0), 0.3, {0.0, 1.0, 0.0}), M_PI, {1.0, 0.0, 0.0});
    for (const glm::dvec2 place :
         {glm::dvec2(2.0, -1.0), glm::dvec2(0.0, -2.5), glm::dvec2(-2.0, -2.0), glm::dvec2(1.5, 2.0)}) {
        std::vector<glm::vec3> corners;
        for (const glm::dvec2 corner : {glm::dvec2(-0.75, -0.75), glm::dvec2(0.75, -0.75),
                                        glm::dvec2(0.75, 0.75), glm::dvec2(-0.75, 0.75)}) {
            corners.emplace_back(glm::dvec3(-1.0 - place.x, -place.y, 3.0) +
                                 glm::dvec3(turn * glm::dvec4(corner, 0.0, 0.0)));
        }
        const std::vector<Panel> panels{{{corners[0], corners[1], corners[2]}},
                                        {{corners[0], corners[2], corners[3]}}};
        Model model;
        add_ground(model);
        add_panels(model, panels, Sides::Both);
        const Mean mean = seen_by(model.build(), at_origin(0.5), Strategy::Both, 1024);
        const double expected =
            GroundAlbedo / M_PI * (std::fabs(irradiance_of(panels[0])) + std::fabs(irradiance_of(panels[1])));
        EXPECT_NEAR(mean.value, expected, 1e-3 * expected) << place.x << " " << place.y;
        EXPECT_LT(mean.standard_error, 1e-3 * expected);
    }
}

// Lights only, BSDF only and both find the same light of panels from far away to almost touching.
TEST(TriangleLights, AreTheSameHoweverTheyAreFound) {
    for (const double height : {0.01, 0.1, 0.5, 2.0, 8.0}) {
        Model model;
        add_ground(model, 4.0f);
        const auto z = float(height);
        model.triangles(model.material(lamp(1.0f)),
                        {{{{-0.5f, -0.4f, z}, {0.3f, 0.6f, z}, {0.6f, -0.3f, z}}}});
        const SceneAdapter& world = model.build();
        const view::View view = at_origin(0.5 * height);
        const Mean both = seen_by(world, view, Strategy::Both, 64);
        const Mean lights = seen_by(world, view, Strategy::LightsOnly, 64);
        const Mean bsdf = seen_by(world, view, Strategy::BsdfOnly, 1024);
        EXPECT_GT(both.value, 0.0) << height;
        const auto error = [](const Mean& a, const Mean& b) {
            return 4.5 * (a.standard_error + b.standard_error);
        };
        EXPECT_NEAR(both.value, lights.value, error(both, lights) + 1e-5) << height;
        EXPECT_NEAR(both.value, bsdf.value, error(both, bsdf) + 1e-5) << height;
    }
}

}  // namespace
}  // namespace tessera::embree

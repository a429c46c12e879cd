// Rectangular lights sampled by solid angle: the angle, the distribution of samples, and the variance.
#include "mediator/shading/quad_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "tests/statistics/chi_squared.h"
#include "tests/statistics/panels.h"

namespace tessera::embree {
namespace {

using shading::LightSource;
using shading::QuadView;

// 2 a x 2 b, shining down onto the plane z = 0, seen from the origin.
LightSource quad(glm::dvec3 center, double a, double b) {
    return {.kind = shading::LightQuad,
            .position = glm::vec3(center),
            .direction = {0.0f, 0.0f, -1.0f},
            .edge_u = {1.0f, 0.0f, 0.0f},
            .edge_v = {0.0f, -1.0f, 0.0f},
            .half_size = {float(a), float(b)}};
}

double corner(double x, double y, double z) {
    return std::atan2(x * y, z * std::sqrt(x * x + y * y + z * z));
}
double solid_angle(double x0, double x1, double y0, double y1, double z) {
    return corner(x1, y1, z) - corner(x0, y1, z) - corner(x1, y0, z) + corner(x0, y0, z);
}

struct Case {
    const char* name;
    glm::dvec3 center;
    double a, b;
};

constexpr Case Cases[] = {{"above", {0, 0, 1}, 1, 1},
                          {"close", {0.3, -0.2, 0.05}, 1, 0.7},
                          {"over an edge", {1, 0, 0.5}, 1, 2},
                          {"over a corner", {0.5, 0.5, 0.3}, 0.5, 0.5},
                          {"to the side", {2, 0.4, 0.8}, 1, 1},
                          {"to the side, low", {1.5, 1.2, 0.2}, 1, 1},
                          {"a strip", {0.1, 0.0, 0.5}, 3, 0.05},
                          {"far enough", {0, 0, 3.5}, 0.8, 0.8},
                          {"touching", {0.2, 0.1, 0.002}, 1, 1}};

TEST(QuadLights, SolidAnglesMatchDoublePrecision) {
    for (const double size : {1e-15, 1e-6, 1.0, 1e12}) {
        for (const Case& c : Cases) {
            const QuadView seen = view_quad(quad(size * c.center, size * c.a, size * c.b), glm::vec3(0.0f));
            const glm::dvec3 m = c.center;
            const double exact = solid_angle(m.x - c.a, m.x + c.a, m.y - c.b, m.y + c.b, m.z);
            // Four angles of up to pi / 2 with 3 ulp (2^-23) each, after 6 roundings of their arguments,
            // which count at most half; a place of 1 that is off by 2^-24 turns a corner at the height z by
            // that / z.
            const double bound = 4.0 * (3.0 + 3.0) * 0x1p-23 + 8.0 * 0x1p-24 / std::min(1.0, m.z);
            EXPECT_NEAR(seen.solid_angle, exact, bound) << c.name << " " << size;
        }
    }
    EXPECT_EQ(view_quad(quad({0, 0, -1}, 1, 1), glm::vec3(0.0f)).solid_angle, 0.0f) << "from behind";
    EXPECT_EQ(view_quad(quad({0, 0, 0}, 1, 1), glm::vec3(0.0f)).solid_angle, 0.0f) << "within";
    EXPECT_EQ(view_quad(quad({0, 0, 30}, 1, 1), glm::vec3(0.0f)).solid_angle, 0.0f) << "far";
}

// As many samples in each of 12 x 12 parts as its fraction of the solid angle, and none outside.
TEST(QuadLights, SamplesAreUniformOverTheSolidAngle) {
    constexpr int Parts = 12, Count = 200'000;
    for (const Case& c : Cases) {
        SCOPED_TRACE(c.name);
        const LightSource light = quad(c.center, c.a, c.b);
        const QuadView seen = view_quad(light, glm::vec3(0.0f));
        ASSERT_GT(seen.solid_angle, 0.0f);
        const auto across = [&](int i) { return c.center.x - c.a + 2.0 * c.a * i / Parts; };
        const auto along = [&](int j) { return c.center.y - c.b + 2.0 * c.b * j / Parts; };
        std::vector<double> observed(Parts * Parts), expected(Parts * Parts);
        double all = 0.0;
        for (int i = 0; i < Parts; ++i) {
            for (int j = 0; j < Parts; ++j) {
                double& part = expected[std::size_t(i * Parts + j)];
                part = solid_angle(across(i), across(i + 1), along(j), along(j + 1), c.center.z);
                all += part;
            }
        }
        for (double& part : expected) part *= Count / all;
        CounterRandom random(31);
        for (int i = 0; i < Count; ++i) {
            const glm::vec2 u(float(random.uniform()) * 0.99999994f, float(random.uniform()) * 0.99999994f);
            const glm::vec2 place = sample_quad(seen, light.half_size, u);
            const double x = double(place.x) / c.a, y = -double(place.y) / c.b;
            ASSERT_LE(std::max(std::fabs(x), std::fabs(y)), 1.0 + 1e-5);
            const int column = std::clamp(int((x + 1.0) / 2.0 * Parts), 0, Parts - 1);
            const int row = std::clamp(int((y + 1.0) / 2.0 * Parts), 0, Parts - 1);
            ++observed[std::size_t(column * Parts + row)];
        }
        test::expect_fit(observed, expected);
    }
}

// Irradiance of the ground below: both estimates have Lambert's mean. By area the nearest part of a close
// light is rarely sampled, with a large weight.
TEST(QuadLights, SolidAngleSamplingReducesVarianceNearby) {
    for (const Case& c : Cases) {
        const LightSource light = quad(c.center, c.a, c.b);
        const QuadView seen = view_quad(light, glm::vec3(0.0f));
        QuadView flat = seen;
        flat.solid_angle = 0.0f;
        const float inverse_root_area = float(0.5 / std::sqrt(c.a * c.b));
        const auto estimate = [&](const QuadView& view) {
            return mean_over_square([&](const glm::vec2& u) {
                const glm::vec2 place = sample_quad(view, light.half_size, u);
                const glm::vec3 to_point = light.position + place.x * light.edge_u + place.y * light.edge_v;
                const float distance = glm::length(to_point), cosine = to_point.z / distance;
                return double(cosine) / double(quad_pdf(view, inverse_root_area, distance, cosine));
            });
        };
        std::array<glm::vec3, 4> corners;
        for (std::size_t i = 0; i < 4; ++i) {
            corners[i] = light.position +
                         (i == 1 || i == 2 ? 1.0f : -1.0f) * light.half_size.x * light.edge_u +
                         (i < 2 ? 1.0f : -1.0f) * light.half_size.y * light.edge_v;
        }
        const double exact = irradiance_of({{corners[0], corners[1], corners[2]}}) +
                             irradiance_of({{corners[0], corners[2], corners[3]}});
        const auto [mean, by_angle] = estimate(seen);
        const auto [other, by_area] = estimate(flat);
        std::printf("%-14s variance by solid angle / by area: %.3f\n", c.name,
                    by_angle * by_angle / (by_area * by_area));
        EXPECT_NEAR(mean, exact, 4.5 * by_angle + 1e-5 * exact) << c.name;
        EXPECT_LE(by_angle, 0.003 * exact) << c.name;
        if (by_area < 0.01 * exact) {
            EXPECT_NEAR(other, exact, 4.5 * by_area) << c.name;
        }
        EXPECT_LT(by_angle, by_area) << c.name;
    }
}

// Close above the ground, by all strategies: their MIS weights sum to 1.
TEST(QuadLights, StrategiesAgreeForCloseLights) {
    Model model;
    add_ground(model);
    const glm::dvec3 center(0.3, 0.1, 0.15);
    model.light({.kind = scene::LightKind::Quad, .intensity = glm::vec3(1.0f), .size = {1.0f, 0.6f}},
                glm::translate(glm::dmat4(1.0), center));
    const SceneAdapter& world = model.build();
    const double radiance = 1.0 / 0.6;
    std::array<glm::vec3, 4> c;
    for (std::size_t i = 0; i < 4; ++i) {
        c[i] = glm::vec3(center + glm::dvec3(i == 1 || i == 2 ? 0.5 : -0.5, i < 2 ? 0.3 : -0.3, 0.0));
    }
    const double expected =
        GroundAlbedo / M_PI *
        (irradiance_of({{c[0], c[1], c[2]}, radiance}) + irradiance_of({{c[0], c[2], c[3]}, radiance}));
    // The eye is below the light.
    for (const Strategy strategy : {Strategy::Both, Strategy::LightsOnly}) {
        expect_light(seen_by(world, at_origin(0.1), strategy, 1024), expected);
    }
    expect_light(seen_by(world, at_origin(0.1), Strategy::BsdfOnly, 1024), expected, 0.04);
}

}  // namespace
}  // namespace tessera::embree

#include "client/import/polygon.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "mediator/base/random.h"

namespace tessera::import {
namespace {

using Outline = std::vector<glm::vec3>;

double doubled_area(const Outline& outline, const std::array<std::uint32_t, 3>& triangle,
                    const glm::dvec3& normal) {
    const glm::dvec3 a(outline[triangle[0]]), b(outline[triangle[1]]), c(outline[triangle[2]]);
    return glm::dot(glm::cross(b - a, c - a), normal);
}

// Every triangle has the winding of the outline, and their areas add up to its area: no gaps, no overlaps.
void expect_tiling(const Outline& outline) {
    const glm::dvec3 area = polygon_area(outline);
    const auto triangles = triangles_of_polygon(outline, PolygonShape::Any);
    ASSERT_EQ(triangles.size(), outline.size() - 2);
    double sum = 0.0;
    for (const auto& triangle : triangles) {
        const double part = doubled_area(outline, triangle, glm::normalize(area));
        EXPECT_GE(part, -1e-9 * glm::length(area));
        sum += part;
    }
    EXPECT_NEAR(sum, glm::length(area), 1e-6 * glm::length(area));
}

TEST(Polygon, ConcaveOutlinesAreTiled) {
    expect_tiling({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.2f, 0}, {0, 2, 0}});
    expect_tiling({{0, 0, 0}, {0, 2, 0}, {1, 0.2f, 0}, {2, 2, 0}, {2, 0, 0}});
    expect_tiling({{0, 5, 0}, {0, 5, 3}, {1, 5, 3}, {1, 5, 1}, {3, 5, 1}, {3, 5, 0}});
    expect_tiling({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 1}, {1, 1, 1}, {0, 1, 1}});
}

TEST(Polygon, StarsInAnyPlaneAreTiled) {
    CounterRandom random(11);
    for (int round = 0; round < 100; ++round) {
        const glm::dvec3 u = glm::normalize(
            glm::dvec3(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5));
        const glm::dvec3 v = glm::normalize(glm::cross(u, glm::dvec3(0.3, 0.5, 0.8)));
        const std::size_t corners = 3 + random.below(60);
        Outline outline;
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle =
                2.0 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(corners);
            const double radius = 0.05 + random.uniform();
            outline.emplace_back(radius * (std::cos(angle) * u + std::sin(angle) * v));
        }
        SCOPED_TRACE(round);
        expect_tiling(outline);
    }
}

TEST(Polygon, AnOutlineThatCrossesItselfEnds) {
    const Outline bow{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    EXPECT_EQ(triangles_of_polygon(bow, PolygonShape::Any).size(), 2u);
    const Outline point(7, glm::vec3(1.0f));
    EXPECT_EQ(triangles_of_polygon(point, PolygonShape::Any).size(), 5u);
    EXPECT_TRUE(triangles_of_polygon(Outline(2), PolygonShape::Any).empty());
    EXPECT_TRUE(triangles_of_polygon(Outline{}, PolygonShape::Convex).empty());
}

}  // namespace
}  // namespace tessera::import

// No ray leaves a closed mesh through its edges and corners.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "mediator/shading/sampling.h"
#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

namespace {

// Rays from inside at corners, at points of edges, and within a few ulp of them. Count of those that escape.
std::uint32_t escapes(const TestMesh& mesh, const TestInstance& placed, const glm::vec3& inside,
                      std::uint32_t count) {
    const TracedScene scene({mesh}, {placed});
    CounterRandom random(31);
    std::uint32_t escaped = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::uvec3& t = mesh.triangles[random.below(mesh.triangles.size())];
        const glm::vec3 a = mesh.positions[t.x], b = mesh.positions[t.y];
        glm::vec3 target = i % 2 == 0 ? a : glm::mix(a, b, static_cast<float>(random.uniform()));
        if (i % 3 == 0) target *= 1.0f + random_point(random, -3e-7f, 3e-7f);
        const glm::vec3 origin =
            placed.linear * (inside + random_point(random, -0.02f, 0.02f)) + placed.translation;
        const TestRay ray{origin, placed.linear * target + placed.translation - origin};
        escaped += scene.trace(ray).instance == shading::NoInstance ? 1 : 0;
        escaped += scene.trace(ray, shading::BvhAny).instance == shading::NoInstance ? 1 : 0;
    }
    return escaped;
}

TEST(Watertight, Ball) {
    EXPECT_EQ(escapes(ball(20, 5.0f, glm::vec3(0.0f)), {}, glm::vec3(0.0f), 600'000), 0u);
}

TEST(Watertight, TurnedBallFarAway) {
    const TestInstance placed{0, shading::frame_around(glm::normalize(glm::vec3(1, 2, 3))) * glm::mat3(0.37f),
                              glm::vec3(3e3f, -2e4f, 70.0f)};
    EXPECT_EQ(escapes(ball(20, 5.0f, glm::vec3(0.0f)), placed, glm::vec3(0.0f), 300'000), 0u);
}

// Slivers up to the poles, a centre far from the object's origin.
TEST(Watertight, Slivers) {
    TestMesh mesh = ball(60, 5.0f, {40.0f, 0.0f, -7.0f});
    for (glm::vec3& p : mesh.positions) p.y *= 0.01f;
    EXPECT_EQ(escapes(mesh, {}, {40.0f, 0.0f, -7.0f}, 100'000), 0u) << "flat";
    for (glm::vec3& p : mesh.positions) p.y *= 1e4f;
    EXPECT_EQ(escapes(mesh, {}, {40.0f, 0.0f, -7.0f}, 100'000), 0u) << "long";
}

TEST(Watertight, BoxAlongTheAxes) {
    TestMesh box;
    for (unsigned i = 0; i < 8; ++i) {
        box.positions.emplace_back((i & 1u) ? 1.0f : -1.0f, (i & 2u) ? 1.0f : -1.0f, (i & 4u) ? 1.0f : -1.0f);
    }
    box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    EXPECT_EQ(escapes(box, {}, glm::vec3(0.0f), 100'000), 0u);
    // From the center exactly along axes and diagonals.
    const TracedScene scene({box}, {{}});
    for (int x = -1; x <= 1; ++x) {
        for (int y = -1; y <= 1; ++y) {
            for (int z = -1; z <= 1; ++z) {
                if (x == 0 && y == 0 && z == 0) continue;
                const TestRay ray{glm::vec3(0.0f), glm::vec3(x, y, z)};
                EXPECT_EQ(scene.trace(ray).distance, 1.0f);
            }
        }
    }
}

}  // namespace

}  // namespace tessera::vulkan

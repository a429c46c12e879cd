// Traversal must not change results: a ray finds bit for bit what testing every triangle finds, and, but for
// rounding, what Embree finds.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "tests/bvh/traced_scene.h"

namespace tessera::vulkan {

namespace {

using shading::Hit;

bool equal(const Hit& a, const Hit& b) {
    return a.distance == b.distance && a.barycentric == b.barycentric && a.instance == b.instance &&
           a.triangle == b.triangle;
}

std::string text(const Hit& hit) {
    return std::to_string(hit.instance) + "/" + std::to_string(hit.triangle) + " at " +
           std::to_string(hit.distance);
}

// Rays of many kinds around a scene of that size.
std::vector<TestRay> rays_around(const TracedScene& scene, float size, std::uint32_t count,
                                 std::uint32_t layers) {
    CounterRandom random(17);
    std::vector<TestRay> rays;
    const TestMesh& mesh = scene.mesh(0);
    for (std::uint32_t i = 0; i < count; ++i) {
        TestRay ray{random_point(random, -2.0f * size, 2.0f * size), random_direction(random)};
        const glm::vec3 corner = mesh.positions[random.below(mesh.positions.size())];
        const glm::vec3 other = mesh.positions[random.below(mesh.positions.size())];
        switch (i % 6) {
            case 0:  // along an axis, zeros of both signs, often within the plane of a box's face
                ray.origin[static_cast<int>(i / 6 % 3)] = corner[static_cast<int>(i / 6 % 3)];
                ray.direction = glm::vec3(0.0f);
                ray.direction[static_cast<int>((i / 6 + 1) % 3)] = i % 4 < 2 ? 1.0f : -1.0f;
                ray.direction[static_cast<int>((i / 6 + 2) % 3)] = i % 8 < 4 ? 0.0f : -0.0f;
                break;
            case 1:  // through a corner
                ray.direction = corner - ray.origin;
                break;
            case 2:  // from a corner to another
                ray = {corner, other - corner};
                break;
            case 3:  // a segment
                ray.far = size;
                break;
            default:
                break;
        }
        ray.layers = layers;
        rays.push_back(ray);
    }
    return rays;
}

void expect_tree_unseen(const TracedScene& scene, float size, std::uint32_t count,
                        std::uint32_t layers = shading::AllLayers) {
    std::uint32_t hits = 0, different = 0;
    for (const TestRay& ray : rays_around(scene, size, count, layers)) {
        for (const std::uint32_t question : {shading::BvhClosest, shading::BvhAlpha}) {
            const Hit all = scene.ask_all(ray, question), found = scene.trace(ray, question);
            EXPECT_TRUE(equal(all, scene.trace_bvh2(ray, question)));
            hits += all.instance != shading::NoInstance ? 1 : 0;
            if (equal(all, found)) continue;
            if (++different < 10) ADD_FAILURE() << "all: " << text(all) << ", tree: " << text(found);
        }
        const bool any = scene.trace(ray, shading::BvhAny).instance != shading::NoInstance;
        EXPECT_EQ(any, scene.ask_all(ray).instance != shading::NoInstance);
    }
    EXPECT_EQ(different, 0u);
    EXPECT_GT(hits, count / 8);
}

TestInstance placed(std::uint32_t mesh, CounterRandom& random, float scale, float spread) {
    TestInstance instance{.mesh = mesh};
    const glm::vec3 x = random_direction(random), side = random_direction(random);
    const glm::vec3 z = glm::normalize(glm::cross(x, side));
    instance.linear = glm::mat3(x, glm::cross(z, x), z) * glm::mat3(scale);
    instance.linear[1] *= 0.7f;
    instance.translation = random_point(random, -spread, spread);
    return instance;
}

TEST(Trace, MatchesBruteForce) {
    CounterRandom random(1);
    expect_tree_unseen(TracedScene({random_mesh(random, 500, 10.0f)}, {{}}), 10.0f, 6000);
}

TEST(Trace, MatchesBruteForceWithInstances) {
    CounterRandom random(2);
    std::vector<TestInstance> instances;
    for (std::uint32_t i = 0; i < 40; ++i) instances.push_back(placed(i % 3, random, 0.6f, 10.0f));
    const TracedScene scene(
        {random_mesh(random, 40, 10.0f), ball(6, 4.0f, {1.0f, 2.0f, 0.0f}), random_mesh(random, 1, 5.0f)},
        instances);
    EXPECT_GE(scene.top().tree.depth, 2u);
    expect_tree_unseen(scene, 10.0f, 6000);
}

TEST(Trace, InstancesInOtherLayersAreInvisible) {
    CounterRandom random(12);
    std::vector<TestInstance> instances;
    for (std::uint32_t i = 0; i < 120; ++i) {
        instances.push_back(placed(i % 2, random, 0.6f, 10.0f));
        instances.back().layers = 1u << random.below(4);
    }
    const TracedScene scene({random_mesh(random, 40, 10.0f), ball(6, 4.0f, {1.0f, 2.0f, 0.0f})}, instances);
    for (const std::uint32_t layers : {1u, 2u, 5u, 14u}) expect_tree_unseen(scene, 10.0f, 1500, layers);
    for (const TestRay& ray : rays_around(scene, 10.0f, 100, 16u)) {
        EXPECT_EQ(scene.trace(ray).instance, shading::NoInstance);
        EXPECT_EQ(scene.trace_bvh2(ray).instance, shading::NoInstance);
    }
}

TEST(Trace, MatchesBruteForceAtAllScales) {
    for (const float size : {1e-12f, 1e-6f, 1e-3f, 1e3f, 1e6f, 1e12f}) {
        CounterRandom random(3);
        SCOPED_TRACE(size);
        expect_tree_unseen(TracedScene({random_mesh(random, 100, size)}, {{}}), size, 2000);
    }
}

TEST(Trace, MatchesBruteForceFarFromTheOrigin) {
    CounterRandom random(4);
    TestMesh mesh = random_mesh(random, 200, 10.0f);
    for (glm::vec3& p : mesh.positions) p += glm::vec3(3e4f, -2e5f, 1e3f);
    const TracedScene scene({mesh}, {{}});
    for (std::uint32_t i = 0; i < 4000; ++i) {
        const glm::vec3 target = mesh.positions[random.below(mesh.positions.size())];
        const glm::vec3 origin = i % 2 == 0 ? glm::vec3(0.0f) : target + random_point(random, -30.0f, 30.0f);
        const TestRay ray{origin, target + random_point(random, -1.0f, 1.0f) - origin};
        const Hit all = scene.ask_all(ray), found = scene.trace(ray);
        ASSERT_TRUE(equal(all, found)) << text(all) << " " << text(found);
    }
}

// The rounding error of the transform to object space is larger than the object.
TEST(Trace, MatchesBruteForceWithSmallInstancesFarFromTheOrigin) {
    CounterRandom random(10);
    std::vector<TestInstance> instances;
    for (std::uint32_t i = 0; i < 100; ++i) {
        instances.push_back(placed(0, random, 0.01f, 1.0f));
        instances.back().translation += glm::vec3(3e4f, -2e5f, 1e3f);
    }
    const TracedScene scene({ball(4, 1.0f, glm::vec3(0.0f))}, instances);
    std::uint32_t hits = 0;
    for (std::uint32_t i = 0; i < 20'000; ++i) {
        const glm::vec3 target = instances[i % 100].translation + random_point(random, -0.02f, 0.02f);
        const TestRay ray{target + random_point(random, -2.0f, 2.0f), random_direction(random)};
        const TestRay aimed{ray.origin, target - ray.origin};
        const Hit all = scene.ask_all(aimed), found = scene.trace(aimed);
        ASSERT_TRUE(equal(all, found)) << text(all) << " " << text(found);
        hits += all.instance != shading::NoInstance ? 1 : 0;
    }
    EXPECT_GT(hits, 2'000u);
}

TEST(Trace, MatchesBruteForceForDistantRays) {
    CounterRandom random(5);
    const TracedScene scene({random_mesh(random, 300, 1.0f)}, {{}});
    for (std::uint32_t i = 0; i < 4000; ++i) {
        const glm::vec3 origin = random_direction(random) * std::exp2(static_cast<float>(i % 24));
        const TestRay ray{origin, glm::normalize(random_point(random, -1.0f, 1.0f) - origin)};
        const Hit all = scene.ask_all(ray), found = scene.trace(ray);
        ASSERT_TRUE(equal(all, found)) << text(all) << " " << text(found);
    }
}

TEST(Trace, CoincidentTrianglesResolveToTheLowerIndex) {
    CounterRandom random(6);
    TestMesh mesh = ball(8, 5.0f, glm::vec3(0.0f));
    const std::size_t count = mesh.triangles.size();
    for (int copy = 0; copy < 9; ++copy) {
        for (std::size_t i = 0; i < count; ++i) mesh.triangles.push_back(mesh.triangles[i]);
    }
    const TracedScene scene({mesh}, {{}, {}, {}});
    for (int i = 0; i < 2000; ++i) {
        const TestRay ray{glm::vec3(0.0f), random_direction(random)};
        const Hit hit = scene.trace(ray);
        ASSERT_EQ(hit.instance, 0u);
        ASSERT_LT(hit.triangle, count);
        ASSERT_TRUE(equal(hit, scene.ask_all(ray)));
    }
}

TEST(Trace, EmptyScenes) {
    const TestRay ray{glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)};
    EXPECT_EQ(TracedScene({}, {}).trace(ray).instance, shading::NoInstance);
    const TracedScene empty({TestMesh{}}, {{}});
    EXPECT_EQ(empty.trace(ray).instance, shading::NoInstance);
    EXPECT_EQ(empty.trace(ray).distance, ray.far);
}

TEST(Trace, SkipsInvalidTriangles) {
    const float nan = std::nanf(""), inf = INFINITY;
    TestMesh mesh;
    mesh.add({nan, 0, 5}, {1, 0, 5}, {0, 1, 5});
    mesh.add({-9, -9, 4}, {inf, -9, 4}, {0, 9, 4});
    mesh.add({-9, -9, 3}, {9, -9, 3}, {0, -9, 3});  // no area
    mesh.add({-9, -9, 2}, {-9, -9, 2}, {-9, -9, 2});
    mesh.add({-3e18f, -3e18f, 2}, {3e18f, -3e18f, 2}, {0, 3e18f, 2});
    mesh.add({-9, -9, 7}, {9, -9, 7}, {0, 9, 7});
    const TracedScene scene({mesh}, {{}});
    EXPECT_EQ(scene.tree(0).primitives, std::vector<std::uint32_t>{5});
    const Hit hit = scene.trace({glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f)});
    EXPECT_EQ(hit.triangle, 5u);
    EXPECT_EQ(hit.distance, 7.0f);
}

TEST(Trace, InvalidRaysTerminate) {
    CounterRandom random(8);
    const TracedScene scene({random_mesh(random, 300, 1.0f)}, {{}});
    const float nan = std::nanf("");
    for (const float bad : {nan, INFINITY, -INFINITY, 0.0f}) {
        scene.trace({glm::vec3(bad, 0.0f, 0.0f), glm::vec3(0.0f, bad, 1.0f)});
        scene.trace({glm::vec3(0.0f), glm::vec3(bad)});
        scene.trace({glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, 1.0f), bad, bad});
    }
}

TEST(Trace, SkipsDegenerateInstances) {
    CounterRandom random(9);
    TestInstance flat;
    flat.linear = glm::mat3({1, 0, 0}, {0, 1, 0}, {1, 1, 0});
    TestInstance nowhere;
    nowhere.translation.x = std::nanf("");
    const TracedScene scene({ball(8, 5.0f, glm::vec3(0.0f))}, {flat, nowhere, {}});
    for (int i = 0; i < 100; ++i) {
        EXPECT_EQ(scene.trace({glm::vec3(0.0f), random_direction(random)}).instance, 2u);
    }
}

}  // namespace

}  // namespace tessera::vulkan

// The same traversal code on a device finds the same hits.
#include <cmath>
#include <cstring>
#include <glm/geometric.hpp>

#include "backends/vulkan/ray_cast.h"
#include "mediator/shading/sampling.h"
#include "tests/bvh/traced_scene.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

using shading::Hit;

// Of each of these rays, one is aimed at a corner.
constexpr std::size_t AimedEvery = 4;

std::vector<TestRay> rays_through(const TracedScene& scene, std::uint32_t count) {
    CounterRandom random(51);
    std::vector<TestRay> rays;
    const TestMesh& mesh = scene.mesh(0);
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 origin = random_point(random, -30.0f, 30.0f);
        glm::vec3 target = random_point(random, -25.0f, 25.0f);
        if (i % AimedEvery == 0) target = mesh.positions[random.below(mesh.positions.size())];
        glm::vec3 direction = target - origin;
        if (i % 16 == 1) direction = glm::vec3(0.0f, i % 32 == 1 ? -0.0f : 0.0f, 1.0f);
        rays.push_back({.origin = origin, .direction = direction, .far = i % 3 == 0 ? 0.9f : INFINITY});
    }
    return rays;
}

bool same_bits(const Hit& a, const Hit& b) {
    return std::memcmp(&a, &b, sizeof a) == 0;
}

bool missed(const Hit& hit) {
    return hit.instance == shading::NoInstance;
}

class DeviceTrace : public VulkanTest {
  protected:
    std::vector<Hit> trace(const TracedScene& scene, std::span<const TestRay> rays, Traversal traversal,
                           std::uint32_t question = shading::BvhClosest) {
        const bool plain = traversal == Traversal::Bvh2;
        const Buffer pool = make_buffer(device(), plain ? scene.bvh2_pool() : scene.pool());
        std::vector<shading::RayQuery> asked;
        for (const TestRay& ray : rays) asked.push_back({ray.origin, ray.near, ray.direction, ray.far});
        const RayCast cast(device(), pool, plain ? scene.bvh2_top_place() : scene.top_place(), asked,
                           {.traversal = traversal, .question = question, .passes_every = 3});
        cast.run();
        return cast.hits();
    }

    void expect_same(const TracedScene& scene, std::uint32_t question) {
        const bool any = (question & shading::BvhAny) != 0;
        const std::vector<TestRay> rays = rays_through(scene, 100'000);
        const std::vector<Hit> by_address = trace(scene, rays, Traversal::Address, question);
        const std::vector<Hit> as_texels = trace(scene, rays, Traversal::Texels, question);
        const std::vector<Hit> plain = trace(scene, rays, Traversal::Bvh2, question);
        std::uint32_t hits = 0, different = 0, different_at_corners = 0, other_bits = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit &found = as_texels[i], here = scene.trace(rays[i], question);
            ASSERT_TRUE(same_bits(found, by_address[i]));
            ASSERT_TRUE(any ? missed(found) == missed(plain[i]) : same_bits(found, plain[i]));
            hits += missed(here) ? 0 : 1;
            other_bits += same_bits(here, found) ? 0 : 1;
            const bool same_triangle = here.instance == found.instance && here.triangle == found.triangle;
            if (missed(here) != missed(found) || (!any && !same_triangle)) {
                ++(i % AimedEvery == 0 ? different_at_corners : different);
            } else if (!any && !missed(here)) {
                EXPECT_NEAR(found.distance / here.distance, 1.0f, 1e-2f);
            }
        }
        EXPECT_GT(hits, 20'000u);
        // A device's division may be off by 2.5 ulp, which shows at edges and most at corners. Lavapipe: 0 and 0; an
        // NVIDIA H200: 2.5 % of the rays that are aimed at corners.
        EXPECT_LE(different, 20u);
        EXPECT_LE(different_at_corners, rays.size() / AimedEvery / 20);
        RecordProperty("different", static_cast<int>(different));
        RecordProperty("different_at_corners", static_cast<int>(different_at_corners));
        RecordProperty("other_bits", static_cast<int>(other_bits));
    }
};

std::vector<TestInstance> many_instances() {
    CounterRandom random(52);
    std::vector<TestInstance> instances;
    for (std::uint32_t i = 0; i < 60; ++i) {
        const glm::mat3 frame = shading::frame_around(random_direction(random));
        instances.push_back({i % 2, frame * glm::mat3(0.5f + static_cast<float>(random.uniform())),
                             random_point(random, -25.0f, 25.0f)});
    }
    return instances;
}

TEST_F(DeviceTrace, TrianglesOfAllShapes) {
    CounterRandom random(53);
    expect_same(TracedScene({random_mesh(random, 5000, 25.0f)}, {{}}), shading::BvhClosest);
}

TEST_F(DeviceTrace, Instances) {
    CounterRandom random(54);
    const TracedScene scene({ball(16, 4.0f, glm::vec3(0.0f)), random_mesh(random, 300, 5.0f)},
                            many_instances());
    expect_same(scene, shading::BvhClosest);
    expect_same(scene, shading::BvhAny);
    expect_same(scene, shading::BvhAlpha);
    expect_same(scene, shading::BvhAny | shading::BvhAlpha);
}

TEST_F(DeviceTrace, InvalidRaysAndEmptyScenes) {
    const float nan = std::nanf("");
    const std::vector<TestRay> rays{{glm::vec3(nan), glm::vec3(0, 0, 1)},
                                    {glm::vec3(0.0f), glm::vec3(nan)},
                                    {glm::vec3(0.0f), glm::vec3(0.0f)},
                                    {glm::vec3(INFINITY), glm::vec3(0, 0, -1)}};
    CounterRandom random(55);
    const TracedScene some({random_mesh(random, 500, 1.0f)}, {{}}), none({}, {});
    for (const Traversal traversal : {Traversal::Bvh2, Traversal::Address, Traversal::Texels}) {
        EXPECT_EQ(trace(some, rays, traversal).size(), rays.size());
        for (const Hit& hit : trace(none, rays, traversal)) EXPECT_TRUE(missed(hit));
    }
}

}  // namespace

}  // namespace tessera::vulkan

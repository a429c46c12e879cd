// The same text on a device finds the same hits.
#include <cmath>
#include <glm/geometric.hpp>

#include "mediator/shading/sampling.h"
#include "tests/bvh/trace_address.comp.h"
#include "tests/bvh/trace_texels.comp.h"
#include "tests/bvh/traced_scene.h"
#include "tests/vulkan/vulkan_test.h"

namespace tessera::vulkan {

namespace {

using shading::Hit;

struct AskedRay {
    glm::vec3 origin;
    float near;
    glm::vec3 direction;
    float far;
};

struct Arguments {
    std::uint64_t pool, rays, hits;
    std::uint32_t top, count;
};

std::vector<AskedRay> rays_through(const TracedScene& scene, std::uint32_t count) {
    CounterRandom random(51);
    std::vector<AskedRay> rays;
    const TestMesh& mesh = scene.mesh(0);
    for (std::uint32_t i = 0; i < count; ++i) {
        const glm::vec3 origin = random_point(random, -30.0f, 30.0f);
        glm::vec3 target = random_point(random, -25.0f, 25.0f);
        if (i % 4 == 0) target = mesh.positions[random.below(mesh.positions.size())];
        glm::vec3 direction = target - origin;
        if (i % 16 == 1) direction = glm::vec3(0.0f, i % 32 == 1 ? -0.0f : 0.0f, 1.0f);
        rays.push_back({origin, 1.17549435e-38f, direction, i % 3 == 0 ? 0.9f : INFINITY});
    }
    return rays;
}

class DeviceTrace : public VulkanTest {
  protected:
    std::vector<Hit> trace(const TracedScene& scene, const std::vector<AskedRay>& rays,
                           const PipelineSettings& settings) {
        const Buffer pool = make_buffer(device(), scene.pool());
        const Buffer asked = make_buffer(device(), rays);
        const Buffer hits(device(), rays.size() * sizeof(Hit));
        const ComputePipeline pipeline(device(), settings);
        std::vector<const Buffer*> bound;
        if (!settings.bindings.empty()) bound.push_back(&pool);
        const auto count = static_cast<std::uint32_t>(rays.size());
        run(device(), {.pipeline = &pipeline,
                       .arguments = Arguments{pool.address(), asked.address(), hits.address(),
                                              scene.top_place(), count},
                       .groups = {(count + 63) / 64},
                       .bound = bound,
                       .reads = {&pool, &asked},
                       .writes = {&hits}});
        return download<Hit>(device(), hits);
    }

    void expect_same(const TracedScene& scene, std::uint32_t question) {
        const std::vector<AskedRay> rays = rays_through(scene, 100'000);
        const PipelineSettings address{.name = "trace by address",
                                       .code = shaders::trace_address_comp(),
                                       .constants = {{0, question}},
                                       .push_bytes = sizeof(Arguments)};
        PipelineSettings texels = address;
        texels.name = "trace texels";
        texels.code = shaders::trace_texels_comp();
        texels.bindings = {{0, Binding::Kind::Texels, VK_FORMAT_R32G32B32A32_UINT}};
        const std::vector<Hit> by_address = trace(scene, rays, address),
                               by_texels = trace(scene, rays, texels);
        std::uint32_t hits = 0, different = 0, ulps = 0;
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Hit& found = by_texels[i];
            EXPECT_EQ(0, std::memcmp(&found, &by_address[i], sizeof(Hit)));
            const Hit here =
                scene.trace({rays[i].origin, rays[i].direction, rays[i].near, rays[i].far}, question);
            hits += here.instance != shading::NoInstance ? 1 : 0;
            if ((question & shading::BvhAny) != 0) {
                different +=
                    (here.instance == shading::NoInstance) != (found.instance == shading::NoInstance) ? 1 : 0;
                continue;
            }
            if (here.instance != found.instance || here.triangle != found.triangle) {
                ++different;
            } else if (here.instance != shading::NoInstance) {
                ulps += std::memcmp(&here, &found, sizeof here) != 0 ? 1 : 0;
                EXPECT_NEAR(found.distance / here.distance, 1.0f, 1e-2f);
            }
        }
        EXPECT_GT(hits, 20'000u);
        // Division is exact to 2.5 ulp on some devices: rays at edges and of equal distances may differ.
        EXPECT_LE(different, 20u);
        RecordProperty("different", static_cast<int>(different));
        RecordProperty("other_bits", static_cast<int>(ulps));
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

TEST_F(DeviceTrace, RaysAndScenesThatAreNone) {
    const float nan = std::nanf("");
    const std::vector<AskedRay> rays{{glm::vec3(nan), 0.0f, glm::vec3(0, 0, 1), INFINITY},
                                     {glm::vec3(0.0f), 0.0f, glm::vec3(nan), INFINITY},
                                     {glm::vec3(0.0f), 0.0f, glm::vec3(0.0f), INFINITY},
                                     {glm::vec3(INFINITY), 0.0f, glm::vec3(0, 0, -1), INFINITY}};
    const PipelineSettings settings{
        .name = "trace", .code = shaders::trace_address_comp(), .push_bytes = sizeof(Arguments)};
    CounterRandom random(55);
    EXPECT_EQ(trace(TracedScene({random_mesh(random, 500, 1.0f)}, {{}}), rays, settings).size(), rays.size());
    for (const Hit& hit : trace(TracedScene({}, {}), rays, settings)) {
        EXPECT_EQ(hit.instance, shading::NoInstance);
    }
}

}  // namespace

}  // namespace tessera::vulkan

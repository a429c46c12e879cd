// Deforming meshes are refitted, not rebuilt.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>

#include "backends/embree/path_tracer.h"
#include "backends/embree/scene_adapter.h"
#include "tests/backend/scene_builder.h"
#include "tests/statistics/scene_model.h"
#include "tests/support/cpu_time.h"

namespace tessera::embree {
namespace {

using scene::Geometry;

constexpr ObjectId MeshId{2}, SkyId{3};
constexpr std::uint32_t Side = 100;

std::vector<glm::vec3> waves(double phase) {
    std::vector<glm::vec3> positions;
    for (std::uint32_t y = 0; y <= Side; ++y) {
        for (std::uint32_t x = 0; x <= Side; ++x) {
            const double u = 2.0 * x / Side - 1.0, v = 2.0 * y / Side - 1.0;
            positions.emplace_back(u, v, 0.2 * std::sin(4.0 * u + 3.0 * v + phase));
        }
    }
    return positions;
}

std::vector<std::uint32_t> quads() {
    std::vector<std::uint32_t> indices;
    for (std::uint32_t y = 0; y < Side; ++y) {
        for (std::uint32_t x = 0; x < Side; ++x) {
            const std::uint32_t a = y * (Side + 1) + x, b = a + Side + 1;
            indices.insert(indices.end(), {a, a + 1, b, a + 1, b + 1, b});
        }
    }
    return indices;
}

struct Sea {
    std::shared_ptr<scene::BlobStore> blobs = std::make_shared<scene::BlobStore>();
    DeviceHandle device = make_device({.threads = 1, .blobs = blobs});
    SceneAdapter adapter{device.get(), blobs};
    test::SceneBuilder builder;

    explicit Sea(scene::MotionHint hint) {
        const Geometry mesh{.hint = hint, .indices = blob(quads()), .positions = blob(waves(0.0))};
        edit(builder.edit(
            {scene::Create{MeshId, mesh}, scene::Create{SkyId, scene::Background{}},
             scene::Create{scene::RootId, scene::Root{.children = {MeshId}, .background = SkyId}}}));
    }
    template <class T>
    scene::BlobRef blob(const std::vector<T>& values) {
        return scene::reference(*blobs->insert(std::as_bytes(std::span(values))));
    }
    backend::EditReport edit(const scene::ChangeList& list) {
        EXPECT_TRUE(adapter.apply(list));
        const auto report = adapter.commit();
        EXPECT_TRUE(report);
        return report ? *report : backend::EditReport{};
    }
    backend::EditReport deform(double phase) {
        const Geometry mesh{.positions = blob(waves(phase))};
        return edit(builder.edit({test::SceneBuilder::update<Geometry>(MeshId, &Geometry::positions, mesh)}));
    }
};

std::vector<PathSample> picture(const Sea& sea) {
    const view::View view = test::small_view({0, 0, 2}, 1.0, 48);
    const PathTracer tracer(sea.adapter.tables(), sea.adapter.scene(), view);
    std::vector<PathSample> samples;
    std::uint64_t rays = 0;
    for (std::uint32_t i = 0; i < 48 * 48; ++i) samples.push_back(tracer.trace(i % 48, i / 48, 0, rays));
    return samples;
}

bool same_refitted_bits(const std::vector<PathSample>& a, const std::vector<PathSample>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(PathSample)) == 0;
}

TEST(Refit, MatchesARebuild) {
    Sea refitted(scene::MotionHint::Animated), rebuilt(scene::MotionHint::Unflagged);
    std::vector<PathSample> before = picture(rebuilt);
    EXPECT_TRUE(same_refitted_bits(picture(refitted), before));
    for (const double phase : {0.4, 3.0}) {
        EXPECT_EQ(refitted.deform(phase).refitted, 1u);
        EXPECT_EQ(rebuilt.deform(phase).rebuilt, 1u);
        const std::vector<PathSample> now = picture(rebuilt);
        EXPECT_TRUE(same_refitted_bits(picture(refitted), now)) << phase;
        EXPECT_FALSE(same_refitted_bits(now, before));
        before = now;
    }
}

// By CPU time, so that other processes do not matter. A refit is one pass over the boxes, a tenth of a build
// or less; more than half means that Embree rebuilt the tree.
TEST(Refit, TakesLessThanHalfOfABuild) {
    Sea refitted(scene::MotionHint::Animated), rebuilt(scene::MotionHint::Unflagged);
    std::vector<double> ratios;
    for (int i = 1; i <= 9; ++i) {
        const double start = tessera::test::thread_cpu_seconds();
        refitted.deform(0.1 * i);
        const double between = tessera::test::thread_cpu_seconds();
        rebuilt.deform(0.1 * i);
        ratios.push_back((between - start) / (tessera::test::thread_cpu_seconds() - between));
    }
    std::sort(ratios.begin(), ratios.end());
    EXPECT_LT(ratios[4], 0.5);
}

}  // namespace
}  // namespace tessera::embree

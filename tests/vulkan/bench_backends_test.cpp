// `tessera bench backends` on a small picture: everything is measured for every back-end, and all ray casters find
// the same hits.
#include <gtest/gtest.h>

#include "mediator/shading/bvh_trace.h"
#include "tests/bench/backends/backends_bench.h"
#include "tests/bench/backends/scene_edits.h"
#include "tests/bench/backends/traversal_rays.h"
#include "tests/support/folders.h"

namespace tessera::tools::bench {
namespace {

TEST(BenchBackends, MeasuresAllBackEnds) {
    const auto plan =
        parse_options({.scenes = "cornell", .size = "64x48", .spp = 2, .rays = 4096, .repeat = 2},
                      tessera::bench::bench_targets());
    ASSERT_TRUE(plan);
    const auto silent = [](const auto&) {};
    const auto results = run_backends(*plan, {silent, silent}, silent, {});
    ASSERT_TRUE(results);
    ASSERT_EQ(results->scenes.at(0).targets.size(), 3u);
    for (const TargetResult& target : results->scenes[0].targets) {
        for (const Measure& measure : BackendMeasures) {
            ASSERT_EQ(target.measured.all(measure.key).size(), 2u) << target.name << " " << measure.key;
            const bool uploads = measure.unit == "MB" && target.name == "embree";
            EXPECT_EQ(target.measured.median(measure.key) > 0.0, !uploads)
                << target.name << " " << measure.key;
        }
    }
}

TEST(BenchBackends, AllRayCastersFindTheSameHits) {
    const EditedScene scene = with_edits(load_scene("cornell-spheres", test::scenes_folder()).value());
    std::vector<std::vector<shading::Hit>> closest, any;
    RaySets sets;
    for (const auto& target : tessera::bench::bench_targets()) {
        const auto caster = target.make_caster({.blobs = scene.blobs}, scene.snapshot);
        if (sets.primary.empty()) sets = ray_sets(scene.scene, scene.blobs, 4096, *caster);
        ASSERT_GT(sets.bounce.size(), 1000u);
        caster->take(sets.bounce, tessera::bench::RayQueryKind::Closest);
        caster->cast();
        closest.push_back(caster->hits());
        caster->take(sets.shadow, tessera::bench::RayQueryKind::Any);
        caster->cast();
        any.push_back(caster->hits());
    }
    for (std::size_t other = 1; other < closest.size(); ++other) {
        std::size_t differ = 0;
        for (std::size_t i = 0; i < closest[0].size(); ++i) {
            const shading::Hit &a = closest[0][i], &b = closest[other][i];
            const bool missed = a.instance == shading::NoInstance;
            differ += a.instance != b.instance || (!missed && a.triangle != b.triangle) ? 1 : 0;
            differ +=
                (any[0][i].instance == shading::NoInstance) != (any[other][i].instance == shading::NoInstance)
                    ? 1
                    : 0;
        }
        EXPECT_LE(differ, closest[0].size() / 500) << "rays at edges may hit either side";
    }
}

}  // namespace
}  // namespace tessera::tools::bench

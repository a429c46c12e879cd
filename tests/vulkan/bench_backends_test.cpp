// `tessera bench backends` on a small picture: every back-end is measured in everything, and bare rays meet
// the same things.
#include <gtest/gtest.h>

#include "mediator/shading/bvh_trace.h"
#include "tests/bench/backends/backends_bench.h"
#include "tests/bench/backends/bare_rays.h"
#include "tests/bench/backends/scene_edits.h"
#include "tests/support/folders.h"

namespace tessera::tools::bench {
namespace {

TEST(BenchBackends, MeasuresEverythingOfEveryBackEnd) {
    const auto plan = understand({.scenes = "cornell", .size = "64x48", .spp = 2, .rays = 4096, .repeat = 2},
                                 tessera::bench::contenders());
    ASSERT_TRUE(plan);
    const auto silent = [](const auto&) {};
    const auto results = run_backends(*plan, {silent, silent}, silent, {});
    ASSERT_TRUE(results);
    ASSERT_EQ(results->scenes.at(0).contenders.size(), 3u);
    for (const ContenderResult& contender : results->scenes[0].contenders) {
        for (const Measure& measure : BackendMeasures) {
            ASSERT_EQ(contender.measured.all(measure.key).size(), 2u) << contender.name << " " << measure.key;
            const bool uploads = measure.unit == "MB" && contender.name == "embree";
            EXPECT_EQ(contender.measured.median(measure.key) > 0.0, !uploads)
                << contender.name << " " << measure.key;
        }
    }
}

TEST(BenchBackends, AllCastersFindTheSame) {
    const EditedScene scene = with_edits(load_scene("cornell-spheres", test::scenes_folder()).value());
    std::vector<std::vector<shading::Hit>> closest, any;
    RaySets sets;
    for (const auto& contender : tessera::bench::contenders()) {
        const auto caster = contender.make_caster({.blobs = scene.blobs}, scene.everything);
        if (sets.primary.empty()) sets = ray_sets(scene.scene, scene.blobs, 4096, *caster);
        ASSERT_GT(sets.bounce.size(), 1000u);
        caster->take(sets.bounce, tessera::bench::Question::Closest);
        caster->cast();
        closest.push_back(caster->hits());
        caster->take(sets.shadow, tessera::bench::Question::Any);
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
        EXPECT_LE(differ, closest[0].size() / 500) << "rays at edges may go either way";
    }
}

}  // namespace
}  // namespace tessera::tools::bench

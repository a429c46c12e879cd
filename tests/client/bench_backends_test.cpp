// The benchmark of back-ends: what it is asked, the edits that it measures, what it reports.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "mediator/backend/catalog.h"
#include "tests/bench/backends/backends_bench.h"
#include "tests/bench/backends/backends_report.h"
#include "tests/bench/backends/scene_edits.h"
#include "tests/support/folders.h"

namespace tessera::tools::bench {
namespace {

std::string refusal(const BackendsOptions& options) {
    const auto plan = parse_options(options, tessera::bench::bench_targets());
    return plan ? "" : plan.error().what();
}

TEST(BenchBackendsPlan, ReportsErrors) {
    EXPECT_EQ(refusal({}), "");
    EXPECT_NE(refusal({.backends = "embre"}).find("choose from embree"), std::string::npos);
    EXPECT_NE(refusal({.scenes = "cornel"}).find("did you mean"), std::string::npos);
    EXPECT_NE(refusal({.scenes = "balls:many"}), "");
    EXPECT_NE(refusal({.output = "speed.txt"}).find(".csv"), std::string::npos);
    EXPECT_NE(refusal({.size = "12"}).find("--size"), std::string::npos);
    EXPECT_NE(refusal({.spp = 0}).find("--spp"), std::string::npos);
    EXPECT_NE(refusal({.rays = 5'000'000}).find("--rays"), std::string::npos);
    EXPECT_NE(refusal({.repeat = 0}).find("--repeat"), std::string::npos);
}

TEST(BenchBackendsPlan, DevicesRequireABackendWithDevices) {
    const auto plan =
        parse_options({.device = "1"}, {{.name = "fixed"}, {.name = "free", .chooses_device = true}});
    ASSERT_TRUE(plan);
    EXPECT_EQ(plan->targets.at(0).device, "");
    EXPECT_EQ(plan->targets.at(1).device, "1");
}

// Also where the mesh lies below a transform already.
TEST(BenchBackendsEdits, AreARefitAndAMove) {
    for (const char* name : {"cornell", "room-1"}) {
        const EditedScene scene = with_edits(load_scene(name, test::scenes_folder()).value());
        EXPECT_GT(scene.triangles, 10u);
        const auto renderer = backend::find_backend("embree").make({.threads = 1, .blobs = scene.blobs});
        const auto edit = [&](const scene::ChangeList& changes) {
            const auto scope = renderer->begin_edit();
            EXPECT_TRUE(scope->apply(changes)) << name;
            return scope->commit().value();
        };
        EXPECT_EQ(edit(scene.snapshot).triangles, scene.triangles) << name;
        const backend::EditReport vertices = edit(scene.deformation), place = edit(scene.movement);
        EXPECT_EQ(vertices.refitted, 1u) << name;
        EXPECT_EQ(vertices.rebuilt, 0u) << name;
        EXPECT_GE(place.retransformed, 1u) << name;
        EXPECT_EQ(place.rebuilt + place.refitted, 0u) << name;
    }
}

TEST(BenchBackendsReport, HasMediansAndRatiosToTheFirst) {
    BackendsResults results{.scenes = {{.name = "a, \"b\"", .targets = {{.name = "x"}, {.name = "y"}}}}};
    for (const double rate : {1e6, 9e6, 2e6}) results.scenes[0].targets[0].measured.add("samples", rate);
    for (const double rate : {1e6, 3e6}) results.scenes[0].targets[1].measured.add("samples", rate);
    for (const int target : {0, 1}) results.scenes[0].targets[target].measured.add("build_bytes", 0);
    results.scenes[0].targets[1].measured.add("build_bytes", 2e6);

    const auto json = nlohmann::json::parse(as_json(results));
    const auto& second = json["scenes"][0]["backends"][1]["measures"];
    EXPECT_EQ(json["scenes"][0]["backends"][0]["measures"]["samples"]["median"], 2.0);
    EXPECT_EQ(second["samples"]["median"], 2.0);
    EXPECT_EQ(second["samples"]["ratio"], 1.0);
    EXPECT_EQ(second["samples"]["all"].size(), 2u);
    EXPECT_TRUE(second["build_bytes"]["ratio"].is_null()) << "no ratio to nothing";
    EXPECT_NE(as_csv(results).find("\"a, \"\"b\"\"\",0,y,\"\",samples,Msamples/s,2,1\n"), std::string::npos);
    EXPECT_NE(as_table(results.scenes[0]).find("1x"), std::string::npos);
}

}  // namespace
}  // namespace tessera::tools::bench

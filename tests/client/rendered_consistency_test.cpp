// Filters that say they are consistent, on path-traced pictures: 96 x 54, against two independent references.
#include <gtest/gtest.h>

#include <filesystem>

#include "master/filter/catalog.h"
#include "tests/bench/filters/plan.h"
#include "tests/bench/filters/run_bench.h"
#include "tests/support/folders.h"

namespace tessera::tools::bench {
namespace {

namespace fs = std::filesystem;

TEST(RenderedConsistency, NeverFivePercentWorseThanNoFilterInRenderedRooms) {
    const fs::path folder =
        fs::temp_directory_path() / ("tessera-rendered-consistency-" + std::to_string(::getpid()));
    BenchOptions options;
    options.output = folder.string();
    options.assets = test::scenes_folder();
    options.scenes = "cornell,room-1";
    options.filters = "pixel,fdf,psvgf,statmc,nfor,gauss:sigma=4";
    options.spp = "4,16,64,256";
    options.size = "96x54";
    options.large = "none";
    options.reference_spp = 512;
    options.jobs = 2;
    auto plan = parse_options(options, filter::catalog());
    ASSERT_TRUE(plan) << plan.error().what();
    plan->path_spp.clear();
    plan->measures_speed = false;
    const auto results = run_bench(*plan, SilentProgress, {});
    ASSERT_TRUE(results);
    bool blur_was_worse = false;
    int checked = 0;
    for (const SceneResult& scene : results->scenes) {
        for (const Row& row : scene.sizes.front().rows) {
            if (row.filter == "none") continue;
            if (row.filter.starts_with("gauss")) {
                blur_was_worse |= row.all.to_unfiltered > 2.0;
                continue;
            }
            EXPECT_LE(row.all.to_unfiltered, 1.05) << row.filter << " in " << scene.name << " at " << row.spp;
            if (row.spp == 4) {
                EXPECT_LE(row.all.to_unfiltered, 0.6) << row.filter << " in " << scene.name;
            }
            ++checked;
        }
    }
    EXPECT_EQ(checked, 2 * 5 * 4);
    EXPECT_TRUE(blur_was_worse);  // the references can tell
    fs::remove_all(folder);
}

}  // namespace
}  // namespace tessera::tools::bench

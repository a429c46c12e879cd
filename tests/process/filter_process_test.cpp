// Filters through real processes: two nodes over CURVE, one process and a saved film give the same picture.
#include <gtest/gtest.h>

#include "master/filter/catalog.h"
#include "mediator/picture/exr_reader.h"
#include "tests/process/real_cluster.h"
#include "tests/support/environment.h"

namespace tessera::test {
namespace {

using nlohmann::json;

class Filters : public testing::TestWithParam<std::string> {};

std::vector<std::string> path_class_of(const std::string& filter) {
    for (const auto& entry : filter::catalog()) {
        if (entry.description.name != filter) continue;
        if (entry.description.path_class == view::PathClass::Diffuse) return {"--path-class", "diffuse"};
    }
    return {};
}

// The cluster is started once for all filters. All programs find the stand-in for a library that is optional.
RealCluster& cluster() {
    static const EnvironmentVariable libraries("LD_LIBRARY_PATH", library_path(open_image_denoise()));
    static RealCluster cluster;
    static const ChildProcess a = cluster.start_node("a"), b = cluster.start_node("b");
    return cluster;
}

TEST_P(Filters, MatchASingleProcessAndTheSavedFilmBitwise) {
    const std::string scene = scene_file("room-1.glb");
    const std::string label = GetParam();
    std::vector<std::string> options{"--size", "96x54", "--spp", "4", "--filter", label, "--save-statistics"};
    for (const std::string& word : path_class_of(label)) options.push_back(word);
    std::vector<std::string> shared = options;
    shared.insert(shared.end(), {"--wait-nodes", "2:60"});
    const json two = cluster().render("two-" + label, scene, shared);
    ASSERT_TRUE(two.contains("picture")) << two.dump(1);
    EXPECT_EQ(two["nodes"].size(), 2u);
    const json one = render_embedded(cluster().folder(), "one-" + label, scene, options);
    EXPECT_EQ(two["film_hash"], one["film_hash"]);
    const std::string two_file = cluster().folder() / ("two-" + label + ".exr");
    const std::string one_file = cluster().folder() / ("one-" + label + ".exr");
    const auto picture = picture::read_exr(two_file);
    EXPECT_EQ(picture.image.values, picture::read_exr(one_file).image.values);

    const std::string again = cluster().folder() / ("again-" + label + ".exr");
    ChildProcess filter(cluster().folder().path(), "filter-" + label, "tessera",
                        {"filter", two_file, "-o", again, "--filter", label});
    ASSERT_EQ(filter.wait(std::chrono::minutes(2)).value_or(-1), 0) << filter.err();
    EXPECT_EQ(picture::read_exr(again).image.values, picture.image.values);
}

std::vector<std::string> names() {
    std::vector<std::string> result;
    for (const auto& entry : filter::catalog()) result.emplace_back(entry.description.name);
    return result;
}
INSTANTIATE_TEST_SUITE_P(Catalog, Filters, testing::ValuesIn(names()));

TEST(FilterCommand, ReportsErrors) {
    const TemporaryFolder folder;
    const auto run = [&](std::vector<std::string> words) {
        ChildProcess process(folder.path(), "filter", "tessera", words);
        const int code = process.wait(std::chrono::minutes(1)).value_or(-1);
        return std::pair(code, process.err());
    };
    EXPECT_EQ(run({"filter", folder / "missing.exr", "-o", folder / "a.exr", "--filter", "gauss"}).first, 2);
    EXPECT_EQ(
        run({"filter", scene_file("env-studio.exr"), "-o", folder / "a.exr", "--filter", "gauss"}).first, 2);
    EXPECT_EQ(run({"filter", scene_file("env-studio.exr"), "-o", folder / "a.exr", "--filter", "gaus"}).first,
              64);
    EXPECT_EQ(
        run({"filter", scene_file("env-studio.exr"), "-o", folder / "a.txt", "--filter", "gauss"}).first, 64);
    EXPECT_EQ(run({"filters", "--json"}).first, 0);
    EXPECT_FALSE(std::filesystem::exists(folder / "a.exr"));
}

}  // namespace
}  // namespace tessera::test

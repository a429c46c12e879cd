// `tessera render` with samples where they are needed: --noise, --time, --adaptive, --noise-map.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "mediator/picture/exr_reader.h"
#include "mediator/picture/png_reader.h"
#include "tests/process/real_cluster.h"

namespace tessera::test {
namespace {

struct AdaptiveRender : testing::Test {
    TemporaryFolder folder;
    std::string scene = scene_file("room-1.glb");

    // Most samples of a pixel over the fewest.
    double spread(const std::string& label) const {
        const auto counts = picture::read_exr(folder / (label + ".exr"), "samples");
        const auto [least, most] = std::ranges::minmax(counts.image.values);
        return double(most) / double(least);
    }
};

TEST_F(AdaptiveRender, StopsAtANoise) {
    const std::vector<std::string> options{"--size", "64x48", "--noise", "0.3"};
    const nlohmann::json steps = render_embedded(folder, "steps", scene, options);
    EXPECT_GT(steps["noise"], 0.0);
    EXPECT_LE(steps["noise"], 0.3);
    EXPECT_GE(spread("steps"), 2.0);
    const nlohmann::json again = render_embedded(
        folder, "again", scene, {"--size", "64x48", "--noise", "0.3", "--nodes", "2", "--threads", "1"});
    EXPECT_EQ(again["film_hash"], steps["film_hash"]);
    const nlohmann::json uniform =
        render_embedded(folder, "uniform", scene, {"--size", "64x48", "--noise", "0.3", "--adaptive", "off"});
    EXPECT_LE(uniform["noise"], 0.3);
    EXPECT_EQ(spread("uniform"), 1.0);
}

TEST_F(AdaptiveRender, StopsAtTheErrorOfTheDenoisedPicture) {
    const nlohmann::json denoised =
        render_embedded(folder, "denoised", scene, {"--size", "64x48", "--denoise", "--error", "0.05"});
    EXPECT_GT(denoised["error"], 0.0);
    EXPECT_LE(denoised["error"], 0.05);
    const nlohmann::json samples =
        render_embedded(folder, "samples", scene, {"--size", "64x48", "--error", "0.09"});
    EXPECT_LE(samples["error"], 0.09);
    EXPECT_NEAR(samples["error"], std::pow(double(samples["noise"]), 2), 1e-9);
    const auto exit_code = [&](const std::vector<std::string>& options) {
        std::vector<std::string> all{"render", scene, "-o", folder / "no.png", "--size", "64x48"};
        all.insert(all.end(), options.begin(), options.end());
        ChildProcess process(folder.path(), "no", "tessera", all);
        return process.wait(std::chrono::minutes(2)).value_or(-1);
    };
    EXPECT_EQ(exit_code({"--error", "0"}), 64);
    EXPECT_EQ(exit_code({"--error", "0.1", "--noise", "0.1"}), 64);
    EXPECT_EQ(exit_code({"--error", "0.1", "--denoise=nfor"}), 64) << "the film has no halves of its halves";
    EXPECT_FALSE(std::filesystem::exists(folder / "no.png"));
}

TEST_F(AdaptiveRender, TimeAndSamplesAreUpperBounds) {
    const nlohmann::json both =
        render_embedded(folder, "both", scene, {"--size", "64x48", "--spp", "24", "--time", "300s"});
    EXPECT_EQ(both["spp"], 24);
    EXPECT_EQ(spread("both"), 1.0);
    const nlohmann::json time = render_embedded(folder, "time", scene, {"--size", "32x24", "--time", "3s"});
    EXPECT_GT(time["noise"], 0.0) << "there was a decision";
    EXPECT_GT(time["spp"], 16.0);
}

TEST_F(AdaptiveRender, WritesANoiseMap) {
    const auto run = [&](const std::string& map) {
        ChildProcess process(folder.path(), "map", "tessera",
                             {"render", scene, "-o", folder / "a.png", "--size", "64x48", "--spp", "4",
                              "--denoise", "--noise-map", map});
        return process.wait(std::chrono::minutes(2)).value_or(-1);
    };
    ASSERT_EQ(run(folder / "map.png"), 0);
    std::ifstream file(folder / "map.png", std::ios::binary);
    const std::string bytes(std::istreambuf_iterator<char>(file), {});
    const auto map = picture::read_png(std::as_bytes(std::span(bytes)));
    ASSERT_TRUE(map);
    EXPECT_EQ(map->width, 64u);
    EXPECT_EQ(map->height, 48u);
    const auto [least, most] = std::ranges::minmax(map->values);
    EXPECT_LT(least, most);
    std::filesystem::remove(folder / "a.png");
    for (const char* wrong : {"map.exr", "missing/map.png"}) EXPECT_EQ(run(folder / wrong), 64) << wrong;
    EXPECT_FALSE(std::filesystem::exists(folder / "a.png")) << "it is refused before the picture is rendered";
}

}  // namespace
}  // namespace tessera::test
